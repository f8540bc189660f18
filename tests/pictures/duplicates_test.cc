#include "colmap_seapoint/pictures/duplicates.h"

#include "tests/io/test_database.h"

namespace colmap_seapoint {
namespace {

TEST(LeaveOutDuplicates, TheFirstOfEqualFilesStays) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "copy");
  for (const char* name : {"a.png", "copy/a.png"})
    WriteImage(dir / name, GrayImage(64, 48, 1, 100));
  WriteImage(dir / "b.png", GrayImage(64, 48, 1, 101));  // of one size with them
  WriteImage(dir / "c.png", GrayImage(48, 64, 1, 100));
  std::vector<ReadablePicture> pictures;
  for (const char* name : {"a.png", "b.png", "c.png", "copy/a.png", "gone.png"}) {
    pictures.push_back({name, {}});
  }
  for (const int num_threads : {1, 3}) {
    std::vector<ReadablePicture> kept = pictures;
    testing::internal::CaptureStderr();
    const auto left_out = LeaveOutDuplicates(dir.Path(), num_threads, &kept);
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "warning: 1 picture is there twice and left out once: copy/a.png is the same file as "
              "a.png\n");
    ASSERT_EQ(kept.size(), 4u);
    EXPECT_EQ(kept[3].name, "gone.png");
    ASSERT_EQ(left_out.size(), 1u);
    EXPECT_EQ(left_out[0].name, "copy/a.png");
    EXPECT_EQ(left_out[0].reason, "is the same file as a.png");
  }
}

TEST(LeaveOutDuplicates, NothingToSay) {
  std::vector<ReadablePicture> none;
  testing::internal::CaptureStderr();
  EXPECT_TRUE(LeaveOutDuplicates("/nowhere", 2, &none).empty());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace colmap_seapoint
