// The smaller questions before something is written: is it the same file, may it be replaced, is it
// as it was, is somebody at work on it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "colmap_seapoint/io/outputs/file_record.h"
#include "colmap_seapoint/io/outputs/replaceable_file.h"
#include "colmap_seapoint/io/outputs/run_lock.h"
#include "colmap_seapoint/io/outputs/same_file.h"
#include "tests/expect_error.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

TEST(SameFile, IsToldByWhereThePathLeads) {
  const TempDir dir;
  WriteBytes(dir / "a", "x");
  WriteBytes(dir / "b", "x");
  fs::create_symlink(dir / "a", dir / "link");
  fs::create_hard_link(dir / "a", dir / "hard");
  fs::create_directory(dir / "folder");
  fs::create_directory_symlink(dir.Path(), dir / "folder/up");
  for (const char* other : {"a", "./a", "folder/../a", "link", "hard", "folder/up/a"}) {
    EXPECT_TRUE(IsSameFile(dir / "a", dir / other)) << other;
    EXPECT_TRUE(IsSameFile(dir / other, dir / "a")) << other;
  }
  EXPECT_FALSE(IsSameFile(dir / "a", dir / "b"));
  EXPECT_TRUE(IsSameFile(dir / "folder", dir / "folder/"));
  // What is not there yet.
  EXPECT_TRUE(IsSameFile(dir / "new", dir / "folder/up/new"));
  EXPECT_TRUE(IsSameFile(dir / "new/", dir / "./new"));
  EXPECT_FALSE(IsSameFile(dir / "new", dir / "folder/new"));
  EXPECT_FALSE(IsSameFile(dir / "new", dir / "a"));
}

TEST(Replaceable, IsWhatOnlyWeWrite) {
  const TempDir dir;
  const auto check = [&](const std::string& name) {
    CheckReplaceable(dir / name, "our words", "choose another");
  };
  EXPECT_NO_THROW(check("new"));
  WriteBytes(dir / "empty", "");
  EXPECT_NO_THROW(check("empty"));
  WriteBytes(dir / "ours", "{ our words }");
  EXPECT_NO_THROW(check("ours"));
  WriteBytes(dir / "mine", "mine alone");
  EXPECT_ERROR(check("mine"),
               "mine: is there already, and was not made by colmap_seapoint; choose");
  WriteBytes(dir / "late", std::string(5000, ' ') + "our words");
  EXPECT_ERROR(check("late"), "was not made by");
  fs::create_symlink(dir / "ours", dir / "link");
  EXPECT_ERROR(check("link"), "is a link");
  EXPECT_ERROR(CheckReplaceable("/dev/null", "our words", "choose another"), "was not made by");
}

class FileRecords : public testing::Test {
 protected:
  FileRecords() {
    WriteBytes(dir_ / "cloud", "0123456789");
    WriteBytes(dir_ / "model/b", "");
    WriteBytes(dir_ / "model/a/c", "x");
    records_ = RecordFiles(dir_.Path(), {dir_ / "cloud", dir_ / "model"});
  }
  std::string Problem(size_t i) const { return RecordProblem(dir_.Path(), records_.at(i)); }

  TempDir dir_;
  std::vector<FileRecord> records_;
};

TEST_F(FileRecords, AreOfEveryFile) {
  ASSERT_EQ(records_.size(), 3u);
  EXPECT_EQ(records_[0].path, "cloud");
  EXPECT_EQ(records_[0].size, 10u);
  EXPECT_EQ(records_[1].path, "model/a/c");
  EXPECT_EQ(records_[2].path, "model/b");
  for (size_t i = 0; i < records_.size(); ++i) EXPECT_EQ(Problem(i), "");
  EXPECT_ERROR(RecordFiles(dir_.Path(), {dir_ / "missing"}), "missing");
}

TEST_F(FileRecords, SeeWhatHasChanged) {
  const std::string cloud = (dir_ / "cloud").string();
  WriteBytes(dir_ / "cloud", "012345678");
  EXPECT_EQ(Problem(0), cloud + " holds 9 bytes instead of 10");
  WriteBytes(dir_ / "cloud", "0123456780");
  EXPECT_EQ(Problem(0), cloud + " does not hold what was written");
  fs::remove(dir_ / "cloud");
  EXPECT_EQ(Problem(0), cloud + " is gone");
  fs::create_directory(dir_ / "cloud");
  EXPECT_EQ(Problem(0), cloud + " is gone");
  WriteBytes(dir_ / "model/b", "y");
  EXPECT_NE(Problem(2), "");
  EXPECT_EQ(Problem(1), "");
}

TEST(RunLock, EndsWithItsObjectAndLeavesNoFile) {
  const TempDir dir;
  for (int i = 0; i < 2; ++i) {
    const RunLock lock = LockFile(dir / "d.db", "--database_path");
    EXPECT_TRUE(fs::exists(dir / "d.db.lock"));
    EXPECT_ERROR(LockFile(dir / "d.db", "--database_path"),
                 "d.db: another run is at work there; wait for it to end, or choose another "
                 "--database_path");
    EXPECT_NO_THROW(LockFile(dir / "e.db", "--database_path"));
  }
  EXPECT_TRUE(fs::is_empty(dir.Path()));
  EXPECT_ERROR(LockFile(dir / "missing/d.db", "--database_path"), "cannot be created");
}

TEST(RunLock, OfAKilledRunIsNone) {
  const TempDir dir;
  const pid_t other = fork();
  if (other == 0) {
    const RunLock lock = LockFile(dir / "d.db", "--database_path");
    kill(getpid(), SIGKILL);
  }
  waitpid(other, nullptr, 0);
  EXPECT_TRUE(fs::exists(dir / "d.db.lock"));
  { EXPECT_NO_THROW(LockFile(dir / "d.db", "--database_path")); }
  EXPECT_FALSE(fs::exists(dir / "d.db.lock"));
}

}  // namespace
}  // namespace colmap_seapoint
