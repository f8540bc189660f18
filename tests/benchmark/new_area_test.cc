#include "examples/benchmarks/densify/new_area.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

// A plane below a steady vehicle: 80 % forward overlap, so that pictures 0, 1, 2 ... see the ground
// from 0, 0.2, 0.4 ... to 1, 1.2, 1.4 ... of a picture's height.
SurveyTruth FlatStrip() {
  SurveyOptions options;
  options.width = 320;
  options.height = 240;
  options.num_strips = 1;
  options.images_per_strip = 8;
  options.forward_overlap = 0.8;
  options.relief = 0;
  options.jitter = 0;
  return MakeSurveyTruth(options);
}

TEST(NewAreaTest, SharesOfAFlatStrip) {
  const SurveyTruth truth = FlatStrip();
  const std::vector<std::array<size_t, 2>> pairs = {{0, 1}, {2, 3}, {6, 7}, {2, 3}};
  const auto previous = NewAreas(truth, pairs, Against::kPreviousPair, 2);
  ASSERT_EQ(previous.size(), 4u);
  constexpr double kTolerance = 0.04;  // the raster's rows, and the lens
  for (const PairArea& area : previous) EXPECT_NEAR(area.seen, 0.8, kTolerance);
  EXPECT_EQ(previous[0].fresh, previous[0].seen);
  // (2, 3) sees 0.6 .. 1.4, of which (0, 1) has seen 0.6 .. 1.
  EXPECT_NEAR(previous[1].fresh, 0.4, kTolerance);
  // (6, 7) sees 1.4 .. 2.2, all new.
  EXPECT_NEAR(previous[2].fresh, 0.8, kTolerance);
  EXPECT_NEAR(previous[3].fresh, 0.8, kTolerance);
  const auto all = NewAreas(truth, pairs, Against::kAllPairs, 1);
  EXPECT_EQ(all[1].fresh, previous[1].fresh);
  EXPECT_EQ(all[3].fresh, 0);
}

}  // namespace
}  // namespace colmap_seapoint
