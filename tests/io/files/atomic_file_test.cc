#include "colmap_seapoint/io/files/atomic_file.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

// Files of this process may not grow beyond `bytes`: a full disk without one.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    signal(SIGXFSZ, handler_);
  }

 private:
  rlimit old_{};
  void (*handler_)(int);
};

TEST(AtomicFile, AppearsWholeOnCommit) {
  const TempDir dir;
  WriteBytes(dir / "a.txt", "old");
  AtomicFile file(dir / "a.txt");
  file.Write("0123456789");
  file.WriteAt(2, "AB", 2);
  file.Write("end");
  EXPECT_EQ(file.Size(), 13u);
  EXPECT_EQ(ReadBytes(dir / "a.txt"), "old");
  file.Commit();
  EXPECT_EQ(ReadBytes(dir / "a.txt"), "01AB456789end");
  EXPECT_FALSE(std::filesystem::exists(dir / "a.txt.tmp"));
}

TEST(AtomicFile, LeavesNothingWithoutCommit) {
  const TempDir dir;
  {
    AtomicFile file(dir / "a.txt");
    file.Write("half");
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir.Path()));
}

TEST(AtomicFile, ReplacesLeftoverAndFollowsNoLink) {
  const TempDir dir;
  WriteBytes(dir / "precious.txt", "precious");
  std::filesystem::create_symlink(dir / "precious.txt", dir / "a.txt.tmp");
  WriteTextFile(dir / "a.txt", "new");
  EXPECT_EQ(ReadBytes(dir / "a.txt"), "new");
  EXPECT_EQ(ReadBytes(dir / "precious.txt"), "precious");
}

TEST(AtomicFile, NamesPathAndRemedy) {
  const TempDir dir;
  EXPECT_ERROR(AtomicFile(dir / "missing/a.txt"), "missing/a.txt: cannot be created");
  std::filesystem::create_directory(dir / "folder");
  EXPECT_ERROR(AtomicFile(dir / "folder"), "is a folder");
  EXPECT_ERROR(AtomicFile("/proc/a.txt"), "/proc/a.txt: cannot be created");
}

TEST(AtomicFile, FullDiskIsAnErrorAndKeepsTheOldFile) {
  const TempDir dir;
  WriteBytes(dir / "a.bin", "old");
  const std::string block(1 << 20, 'x');
  const FileSizeLimit limit(1 << 16);
  EXPECT_ERROR(
      {
        AtomicFile file(dir / "a.bin");
        file.Write(block);
        file.Commit();
      },
      "free some space");
  EXPECT_EQ(ReadBytes(dir / "a.bin"), "old");
  EXPECT_FALSE(std::filesystem::exists(dir / "a.bin.tmp"));
}

TEST(CheckWritableDir, CreatesAndLeavesEmpty) {
  const TempDir dir;
  CheckWritableDir(dir / "a/b");
  EXPECT_TRUE(std::filesystem::is_empty(dir / "a/b"));
}

TEST(CheckWritableDir, RefusesFilesAndForbiddenFolders) {
  const TempDir dir;
  WriteBytes(dir / "file", "x");
  EXPECT_ERROR(CheckWritableDir(dir / "file"), "is a file, not a folder");
  EXPECT_ERROR(CheckWritableDir(dir / "file/below"), "cannot be created");
  EXPECT_ERROR(CheckWritableDir("/proc/self"), "no file can be created");
  if (geteuid() == 0) GTEST_SKIP() << "root may write into any folder";
  std::filesystem::permissions(
      dir.Path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_ERROR(CheckWritableDir(dir.Path()), "no file can be created");
  std::filesystem::permissions(dir.Path(), std::filesystem::perms::owner_all);
}

}  // namespace
}  // namespace colmap_seapoint
