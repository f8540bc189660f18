#include "colmap_seapoint/watch/overlap_watch.h"

#include <gtest/gtest.h>

#include "colmap_seapoint/base/picture.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

NewOverlap AddPicture(int index, OverlapWatch* watch) {
  return watch->Add("img" + std::to_string(index), LumaOf(StripPicture(index)));
}

TEST(OverlapWatch, KnowsTheOverlapOfAStrip) {
  OverlapWatch watch;
  EXPECT_TRUE(AddPicture(0, &watch).is_first);
  constexpr double kNeighbours = 1 - double{kStripStep} / kStripWidth;
  for (int index = 1; index < 5; ++index) {
    const NewOverlap found = AddPicture(index, &watch);
    EXPECT_FALSE(found.is_first);
    EXPECT_NEAR(found.overlap, kNeighbours, 0.05);
    EXPECT_EQ(found.warning, "");
  }
}

TEST(OverlapWatch, SaysWhenItDrops) {
  OverlapWatch watch;
  AddPicture(0, &watch);
  AddPicture(1, &watch);
  const NewOverlap fast = AddPicture(4, &watch);  // three steps on: 32 %
  EXPECT_NEAR(fast.overlap, 1 - 3 * double{kStripStep} / kStripWidth, 0.05);
  EXPECT_NE(fast.warning.find("slow down"), std::string::npos) << fast.warning;
  const NewOverlap lost = AddPicture(20, &watch);
  EXPECT_EQ(lost.overlap, 0);
  EXPECT_NE(lost.warning.find("go back to what img4 shows"), std::string::npos) << lost.warning;
}

// One picture that shows nothing does not make the next one a lost one.
TEST(OverlapWatch, LooksBeyondABlankPicture) {
  OverlapWatch watch;
  AddPicture(0, &watch);
  GrayImage blank(kStripWidth, kStripHeight);
  EXPECT_EQ(watch.Add("blank", blank).overlap, 0);
  EXPECT_EQ(AddPicture(1, &watch).warning, "");
}

}  // namespace
}  // namespace colmap_seapoint
