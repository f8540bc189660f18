#include "feature/matching/local_flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace colmap_seapoint {
namespace {

SeaPoint At(double x, double y) {
  SeaPoint point;
  point.x = static_cast<float>(x);
  point.y = static_cast<float>(y);
  return point;
}

struct Matched {
  std::vector<SeaPoint> points1, points2;
  FeatureMatches matches;
};

// Turned by 30 degrees, swollen by a tenth, shifted.
Eigen::Vector2d Move(double x, double y) {
  const double c = 1.1 * std::cos(M_PI / 6), s = 1.1 * std::sin(M_PI / 6);
  return {c * x - s * y + 70, s * x + c * y - 40};
}

Matched MakeMatches(size_t count) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> place(0, 500);
  Matched all;
  for (uint32_t i = 0; i < count; ++i) {
    const double x = place(generator), y = place(generator);
    all.points1.push_back(At(x, y));
    all.points2.push_back(At(Move(x, y).x(), Move(x, y).y()));
    all.matches.push_back({i, i});
  }
  return all;
}

TEST(LocalFlowTest, SimilaritiesArePredictedExactly) {
  const Matched all = MakeMatches(60);
  LocalFlow flow(all.points1, all.points2, all.matches);
  for (double x = 0; x <= 500; x += 50) {
    const Eigen::Vector2d predicted = flow.Predict(At(x, 500 - x));
    EXPECT_LT((predicted - Move(x, 500 - x)).norm(), 1e-3) << x;
  }
}

TEST(LocalFlowTest, ALeftOutMatchHasNoSay) {
  Matched all = MakeMatches(60);
  all.points2[7].x += 80;
  LocalFlow flow(all.points1, all.points2, all.matches);
  const SeaPoint& place = all.points1[7];
  EXPECT_LT((flow.Predict(place, 7) - Move(place.x, place.y)).norm(), 1e-3);
  EXPECT_GT((flow.Predict(place) - Move(place.x, place.y)).norm(), 3);
  const std::vector<double> slips = flow.Slips();
  EXPECT_NEAR(slips[7], 80, 0.01);
  EXPECT_LT(flow.UsualSlip(place, slips, 7), 40);
}

TEST(LocalFlowTest, OnePlaceMovesAsItDoes) {
  const std::vector<SeaPoint> from(12, At(10, 20)), to(12, At(15, 17));
  FeatureMatches matches;
  for (uint32_t i = 0; i < 12; ++i) matches.push_back({i, i});
  LocalFlow flow(from, to, matches);
  const Eigen::Vector2d predicted = flow.Predict(At(110, 20));
  EXPECT_NEAR(predicted.x(), 115, 1e-6);
  EXPECT_NEAR(predicted.y(), 17, 1e-6);
}

TEST(LocalFlowTest, WithoutMatchesNothingIsKnown) {
  const std::vector<SeaPoint> none;
  const FeatureMatches no_matches;  // lent to the flow, as the points are
  LocalFlow flow(none, none, no_matches);
  EXPECT_TRUE(std::isnan(flow.Predict(At(1, 2)).x()));
  EXPECT_TRUE(flow.Slips().empty());
  EXPECT_EQ(flow.UsualSlip(At(1, 2), {}), 0);
}

}  // namespace
}  // namespace colmap_seapoint
