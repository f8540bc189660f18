#include "colmap_seapoint/estimate/needs.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace colmap_seapoint {
namespace {

JobSize Survey(int64_t num_pictures, double megapixels) {
  JobSize size;
  size.num_pictures = num_pictures;
  size.megapixels = megapixels;
  size.num_threads = 2;
  return size;
}

TEST(Needs, HoldWhatSurveysTook) {
  // Measured: 12 pictures of 1.39 megapixels left 195 MB and had 204 MB in memory at most; 300 of
  // 0.48 left 1.23 GB and had 647 MB; 18 of 9 left 108 MB and had 366 MB.
  const struct {
    JobSize size;
    double disk, memory;
  } measured[] = {{Survey(12, 16.7), 195e6, 204e6},
                  {Survey(300, 144), 1.23e9, 647e6},
                  {Survey(18, 162), 108e6, 366e6}};
  for (const auto& one : measured) {
    const Needs needs = ExpectedNeeds(one.size);
    EXPECT_GE(static_cast<double>(needs.disk_bytes), one.disk);
    EXPECT_LE(0.3 * static_cast<double>(needs.disk_bytes), one.disk * 1.1);
    EXPECT_GE(static_cast<double>(needs.memory_bytes), one.memory);
    EXPECT_LE(static_cast<double>(needs.memory_bytes), 2 * one.memory);
  }
}

TEST(Needs, GrowWithMapsAndFallWithTheStep) {
  JobSize size = Survey(10, 100);
  const uint64_t plain = ExpectedNeeds(size).disk_bytes;
  size.writes_maps = true;
  EXPECT_GT(ExpectedNeeds(size).disk_bytes, plain);
  size.writes_maps = false;
  size.makes_map = true;
  EXPECT_GT(ExpectedNeeds(size).disk_bytes, plain);
  size.makes_map = false;
  size.step = 1;
  EXPECT_GT(ExpectedNeeds(size).disk_bytes, 5 * plain);
  EXPECT_EQ(ExpectedNeeds(JobSize()).disk_bytes, 0u);
}

TEST(JudgeDisk, CountsWhatIsThereAlready) {
  const Needs needs = {1000, 0};
  EXPECT_EQ(JudgeDisk(needs, {1000, 0, 0}), DiskVerdict::kEnough);
  EXPECT_EQ(JudgeDisk(needs, {999, 0, 0}), DiskVerdict::kMayBeFilled);
  EXPECT_EQ(JudgeDisk(needs, {299, 0, 0}), DiskVerdict::kTooSmall);
  EXPECT_EQ(JudgeDisk(needs, {299, 701, 0}), DiskVerdict::kEnough);
  EXPECT_EQ(JudgeDisk(needs, {0, 0, 0}), DiskVerdict::kTooSmall);
  EXPECT_EQ(JudgeDisk(needs, {std::nullopt, 0, 0}), DiskVerdict::kEnough);
}

TEST(FolderBytes, OfAllThatIsThere) {
  const auto folder = std::filesystem::temp_directory_path() / "folder_bytes_test";
  std::filesystem::remove_all(folder);
  EXPECT_EQ(FolderBytes(folder), 0u);
  std::filesystem::create_directories(folder / "a" / "b");
  std::ofstream(folder / "a" / "b" / "file") << "1234567";
  std::ofstream(folder / "file") << "123";
  std::filesystem::create_directory_symlink(folder, folder / "a" / "link");
  EXPECT_EQ(FolderBytes(folder), 10u);
  EXPECT_EQ(FolderBytes(folder / "file"), 3u);
  std::filesystem::remove_all(folder);
}

TEST(Needs, AreTheSumOfTheDisksParts) {
  JobSize size = Survey(12, 16.7);
  size.writes_maps = size.makes_map = true;
  const DiskNeeds disk = ExpectedDiskNeeds(size);
  EXPECT_EQ(ExpectedNeeds(size).disk_bytes,
            disk.database_bytes + disk.model_bytes + disk.cloud_bytes + disk.map_bytes);
  size.makes_map = false;
  EXPECT_EQ(ExpectedDiskNeeds(size).map_bytes, 0u);
  EXPECT_EQ(ExpectedDiskNeeds(size).cloud_bytes, disk.cloud_bytes);
  size.writes_maps = false;
  EXPECT_LT(ExpectedDiskNeeds(size).cloud_bytes, disk.cloud_bytes);
}

TEST(TimesText, LeavesOutWhatIsDone) {
  OfWork<WorkCost> costs;
  costs[Work::kPictures] = {10, 1};
  costs[Work::kDensification] = {10, 6};
  OfWork<bool> done;
  EXPECT_EQ(TimesText(costs, done, 70),
            "About 1 min 10 s on this machine: SeaPoints 10 s, cloud 1 min 00 s");
  done[Work::kPictures] = true;
  EXPECT_EQ(TimesText(costs, done, 60), "About 1 min 00 s on this machine: cloud 1 min 00 s");
}

}  // namespace
}  // namespace colmap_seapoint
