#include "colmap_seapoint/disk/disk_finding.h"

#include <gtest/gtest.h>
#include <sys/mount.h>

#include "colmap_seapoint/system/free_disk.h"
#include "tests/disk/told_disk.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class DiskFindingTest : public testing::Test {
 protected:
  DiskFindingTest() : disk_(folder_.Path()) {
    fs::create_directories(folder_ / "clouds" / "0");
    WriteBytes(folder_ / "clouds" / "0" / "fused.ply", std::string(600, 'x'));
    WriteBytes(folder_ / "database", std::string(5000, 'x'));
  }
  std::vector<DiskNeed> ToCome() const {
    return {{{folder_ / "database"}, 500}, {{folder_ / "clouds", folder_ / "nowhere"}, 1000}};
  }

  TemporaryFolder folder_;
  ToldDisk disk_;
};

// 1500 are to come, of which 500 and 600 are there: what is too much of the one is none of the
// other.
TEST_F(DiskFindingTest, CountsWhatIsThereAlready) {
  disk_.SetFree(1500);
  EXPECT_EQ(ShortestDisk(ToCome()).verdict, DiskVerdict::kEnough);
  disk_.SetFree(400);
  EXPECT_EQ(ShortestDisk(ToCome()).verdict, DiskVerdict::kEnough);
  disk_.SetFree(399);
  const DiskFinding finding = ShortestDisk(ToCome());
  EXPECT_EQ(finding.verdict, DiskVerdict::kMayBeFilled);
  EXPECT_EQ(finding.free_bytes, 399u);
  EXPECT_EQ(finding.needed_bytes, 400u);
  EXPECT_EQ(finding.mount_point, FileSystemOf(folder_.Path()).mount_point);
}

TEST_F(DiskFindingTest, WhatIsLeftCountsAlone) {
  const std::vector<DiskNeed> clouds = {{{folder_ / "later"}, 1000}};
  disk_.SetFree(299);
  EXPECT_EQ(ShortestDisk(clouds).verdict, DiskVerdict::kTooSmall);
  disk_.SetFree(300);
  EXPECT_EQ(ShortestDisk(clouds).verdict, DiskVerdict::kMayBeFilled);
  EXPECT_EQ(ShortestDisk({}).verdict, DiskVerdict::kEnough);
}

TEST_F(DiskFindingTest, ADiskThatDoesNotTellIsLargeEnough) {
  EXPECT_EQ(ShortestDisk(ToCome()).verdict, DiskVerdict::kEnough);
}

// A folder may be a link to a larger disk.
TEST(DiskFinding, EachFileSystemIsJudgedByWhatItTakes) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "small");
  if (mount("tmpfs", (folder / "small").c_str(), "tmpfs", 0, "size=1m") != 0) {
    GTEST_SKIP() << "a small disk cannot be mounted here";
  }
  fs::create_directory_symlink(folder / "small", folder / "dense");
  const DiskNeed database = {{folder / "database"}, 5 << 20}, cloud = {{folder / "dense"}, 5 << 20};
  EXPECT_EQ(ShortestDisk({database}).verdict, DiskVerdict::kEnough);
  const DiskFinding finding = ShortestDisk({database, cloud});
  umount2((folder / "small").c_str(), MNT_DETACH);
  EXPECT_EQ(finding.verdict, DiskVerdict::kTooSmall);
  EXPECT_EQ(finding.mount_point, fs::canonical(folder / "small"));
  EXPECT_EQ(finding.needed_bytes, uint64_t{5} << 20);
}

}  // namespace
}  // namespace colmap_seapoint
