#include "colmap_seapoint/merging/known_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/expect_error.h"

namespace colmap_seapoint {
namespace {

TEST(KnownPlaces, AreKnownOnceSettled) {
  KnownPlaces known(0.5);
  known.Add({1, 2, 3});
  EXPECT_FALSE(known.IsNear({1, 2, 3}));
  known.Settle();
  EXPECT_TRUE(known.IsNear({1, 2, 3}));
  known.Add({-7, 0, 0});
  known.Settle();
  EXPECT_TRUE(known.IsNear({1, 2, 3}));
  EXPECT_TRUE(known.IsNear({-7, 0, 0}));
  EXPECT_FALSE(known.IsNear({-9, 0, 0}));
}

// Against a search through all.
TEST(KnownPlaces, AreNearWithinASpacingAndNeverBeyondTwo) {
  constexpr double kSpacing = 0.01;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  const auto draw = [&] { return Eigen::Vector3d(uniform(random), uniform(random), 0); };
  std::vector<Eigen::Vector3d> places;
  KnownPlaces known(kSpacing);
  for (int i = 0; i < 400; ++i) {
    places.push_back(draw());
    known.Add(places.back());
    if (i % 100 == 0) known.Settle();
  }
  known.Settle();
  int num_near = 0, num_far = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d query = draw();
    double nearest = 1, nearest_along_axes = 1;
    for (const Eigen::Vector3d& place : places) {
      nearest = std::min(nearest, (place - query).norm());
      nearest_along_axes = std::min(nearest_along_axes, (place - query).cwiseAbs().maxCoeff());
    }
    const bool is_near = known.IsNear(query);
    if (nearest <= kSpacing) {
      EXPECT_TRUE(is_near);
    }
    if (nearest_along_axes > 2 * kSpacing) {
      EXPECT_FALSE(is_near);
    }
    num_near += nearest <= kSpacing;
    num_far += nearest_along_axes > 2 * kSpacing;
  }
  EXPECT_GT(num_near, 100);
  EXPECT_GT(num_far, 100);
}

TEST(KnownPlaces, RefusePointsThatTheLatticeDoesNotReach) {
  KnownPlaces known(1e-6);
  EXPECT_ERROR(known.Add({2, 0, 0}), "a million spacings from the origin");
  EXPECT_ERROR(known.IsNear({0, -2, 0}), "a million spacings from the origin");
}

}  // namespace
}  // namespace colmap_seapoint
