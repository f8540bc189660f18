#include "colmap_seapoint/compare/comparison_scores.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

CloudComparison Comparison() {
  CloudComparison c;
  c.distances = {1, 2};
  c.input.num_points = 8;
  c.input.at = {{2, 0.3, 10, 5, 0}, {4, 0.4, 20, 15, 0}};
  c.reference.num_points = 4;
  c.reference.at = {{3, 0.6, 5, 1, 0}, {4, 0.8, 4, 3, 0}};
  return c;
}

void ExpectScores(const ComparisonScores& scores, double accuracy, double completeness) {
  EXPECT_DOUBLE_EQ(scores.accuracy, accuracy);
  EXPECT_DOUBLE_EQ(scores.completeness, completeness);
  EXPECT_DOUBLE_EQ(scores.f_score, 2 / (1 / accuracy + 1 / completeness));
}

TEST(ComparisonScoresTest, SharesOfPointsVoxelsAndReducedPoints) {
  const CloudComparison c = Comparison();
  ExpectScores(PointScores(c, 0), 0.25, 0.75);
  ExpectScores(PointScores(c, 1), 0.5, 1);
  ExpectScores(Eth3dScores(c, 0), 0.3, 0.6);
  ExpectScores(Eth3dScores(c, 1), 0.4, 0.8);
  ExpectScores(TanksScores(c, 0), 0.5, 0.2);
  ExpectScores(TanksScores(c, 1), 0.75, 0.75);
}

TEST(ComparisonScoresTest, TheFScoreOfNothingIsZero) {
  CloudComparison c = Comparison();
  c.input.at[0].num_within = c.reference.at[0].num_within = 0;
  EXPECT_EQ(PointScores(c, 0).f_score, 0);
  c.input.at[0].num_within = 8;  // all of one and none of the other
  EXPECT_EQ(PointScores(c, 0).accuracy, 1);
  EXPECT_EQ(PointScores(c, 0).f_score, 0);
}

}  // namespace
}  // namespace colmap_seapoint
