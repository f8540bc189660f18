#include "colmap_seapoint/io/files/temporary_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <set>

#include "colmap_seapoint/io/files/atomic_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

TEST(TemporaryFile, HasANameOfItsOwn) {
  const TempDir dir;
  std::set<fs::path> paths;
  for (int i = 0; i < 100; ++i) {
    const TemporaryFile file = CreateTemporaryFile(dir.Path());
    ASSERT_GE(file.descriptor, 0);
    EXPECT_TRUE(paths.insert(file.path).second);
    close(file.descriptor);
  }
  EXPECT_EQ(CreateTemporaryFile(dir / "missing").descriptor, -1);
}

TEST(TemporaryFile, HasTheRightsOfAnOrdinaryFile) {
  const TempDir dir;
  const mode_t before = umask(027);
  WriteTextFile(dir / "a.txt", "x");
  umask(before);
  struct stat status {};
  ASSERT_EQ(stat((dir / "a.txt").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST(RemoveLeftovers, TakesWhatNobodyHolds) {
  const TempDir dir;
  const TemporaryFile held = CreateTemporaryFile(dir.Path());
  const TemporaryFile left = CreateTemporaryFile(dir.Path());
  close(left.descriptor);  // as when its run is killed
  WriteBytes(dir / ".seapoint_probe_aB3dE6", "probe");
  WriteBytes(dir / ".seapoint_tiles_aB3dE6", "");
  RemoveLeftovers(dir.Path());
  EXPECT_TRUE(fs::exists(held.path));
  EXPECT_FALSE(fs::exists(left.path));
  EXPECT_FALSE(fs::exists(dir / ".seapoint_probe_aB3dE6"));
  EXPECT_FALSE(fs::exists(dir / ".seapoint_tiles_aB3dE6"));
  close(held.descriptor);
}

TEST(RemoveLeftovers, TakesNothingElse) {
  const TempDir dir;
  const std::vector<std::string> others = {
      "fused.ply.tmp",       ".seapoint_0123456789abcdef",      ".seapoint_0123456789ABCDEF.tmp",
      ".seapoint_.tmp",      ".seapoint_0123456789abcdef.tmp~", "x.seapoint_0123456789abcdef.tmp",
      ".seapoint_probe_abc", ".seapoint_probe_abcdefg",         ".seapoint_probe_ab.def"};
  for (const std::string& name : others) WriteBytes(dir / name, "mine");
  // Of such a name, but no file of ours.
  const fs::path link = dir / ".seapoint_0000000000000000.tmp";
  const fs::path folder = dir / ".seapoint_1111111111111111.tmp";
  fs::create_symlink(dir / "fused.ply.tmp", link);
  fs::create_directory(folder);
  RemoveLeftovers(dir.Path());
  RemoveLeftovers(dir / "missing");
  for (const std::string& name : others) EXPECT_EQ(ReadBytes(dir / name), "mine") << name;
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_TRUE(fs::is_directory(folder));
}

// Two writers of one name: each writes a whole file, and the last one counts.
TEST(AtomicFile, WritersDoNotShareATemporaryFile) {
  const TempDir dir;
  AtomicFile first(dir / "a.txt"), second(dir / "a.txt");
  CheckWritableDir(dir.Path());  // does not take them for leftovers
  first.Write("first");
  second.Write("the second");
  first.Commit();
  EXPECT_EQ(ReadBytes(dir / "a.txt"), "first");
  second.Commit();
  EXPECT_EQ(ReadBytes(dir / "a.txt"), "the second");
}

}  // namespace
}  // namespace colmap_seapoint
