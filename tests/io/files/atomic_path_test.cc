// Files that a library writes by their names.
#include "colmap_seapoint/io/files/atomic_path.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>

#include "colmap_seapoint/io/files/temporary_file.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

bool IsEmptyFolder(const fs::path& folder) { return fs::is_empty(folder); }

TEST(AtomicPath, AppearsWithCommitAndReplaces) {
  const TempDir dir;
  WriteBytes(dir / "file", "old");
  {
    AtomicPath path(dir / "file");
    WriteBytes(path.Temporary(), "new");
    EXPECT_EQ(ReadBytes(dir / "file"), "old");
    path.Commit();
  }
  EXPECT_EQ(ReadBytes(dir / "file"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(dir.Path()), {}), 1);
}

TEST(AtomicPath, WithoutCommitNothingIsLeft) {
  const TempDir dir;
  {
    const AtomicPath path(dir / "file");
    WriteBytes(path.Temporary(), "half");
    // Nor is it taken for what a killed run has left.
    RemoveLeftovers(dir.Path());
    EXPECT_TRUE(fs::exists(path.Temporary()));
  }
  EXPECT_TRUE(IsEmptyFolder(dir.Path()));
}

TEST(AtomicPath, AnotherFileInItsPlaceIsOurOwnBug) {
  const TempDir dir;
  {
    AtomicPath path(dir / "file");
    fs::rename(path.Temporary(), dir / "moved");
    WriteBytes(path.Temporary(), "another");
    EXPECT_THROW(path.Commit(), std::logic_error);
  }
  EXPECT_FALSE(fs::exists(dir / "file"));
}

TEST(AtomicPath, SaysWhyItCannotBeCreated) {
  const TempDir dir;
  EXPECT_ERROR(AtomicPath(dir / "none/file"), "create the folder first");
  EXPECT_ERROR(AtomicPath(dir.Path()), "is a folder");
  EXPECT_EQ(AtomicPath(dir / "file").GrowthError(), 0);
}

}  // namespace
}  // namespace colmap_seapoint
