#include "feature/matching/overlap_share.h"

#include <gtest/gtest.h>

#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr int kSide = 20;

// A lattice of kSide x kSide points, 10 pixels apart, and the same turned by `turn` about its
// middle and moved; every `step`th of those that stay within the lattice's square is a match.
struct Pair {
  Pair(double turn, double dx, double dy, size_t step, int patch = 1000) {
    size_t count = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double x = 10.0 * (i % kSide), y = 10.0 * (i / kSide), half = 5.0 * (kSide - 1);
      const double c = std::cos(turn), s = std::sin(turn);
      const double u = c * (x - half) - s * (y - half) + half + dx;
      const double v = s * (x - half) + c * (y - half) + half + dy;
      points1.push_back({static_cast<float>(x), static_cast<float>(y), 1, 0});
      const auto index = static_cast<uint32_t>(points2.size());
      points2.push_back({static_cast<float>(u), static_cast<float>(v), 1, 0});
      if (u < -1e-3 || v < -1e-3 || u > 10 * kSide - 9.99 || v > 10 * kSide - 9.99) {
        points2.back() = {0, 0, 1, 0};  // out of sight
        continue;
      }
      const bool is_in_patch = std::abs(x - half) < patch && std::abs(y - half) < patch;
      if (is_in_patch && count++ % step == 0) matches.push_back({static_cast<uint32_t>(i), index});
    }
    points2.push_back({10 * kSide - 10, 10 * kSide - 10, 1, 0});
  }
  double Share() const { return OverlapShare(points1, points2, matches); }

  std::vector<SeaPoint> points1, points2;
  FeatureMatches matches;
};

TEST(OverlapShare, CountsWithinTheOverlapOnly) {
  for (const double turn : {0.0, 1.5707963267948966, 3.141592653589793}) {
    for (const double shift : {4.0, 54.0, 124.0, -146.0}) {
      EXPECT_NEAR(Pair(turn, shift, 4, 1).Share(), 1, 0.06) << turn << " " << shift;
      EXPECT_NEAR(Pair(turn, shift, 44, 2).Share(), 0.5, 0.06) << turn << " " << shift;
      EXPECT_NEAR(Pair(turn, 34, shift, 4).Share(), 0.25, 0.05) << turn << " " << shift;
    }
  }
}

TEST(OverlapShare, APatchInTheMidstIsASmallShare) {
  // 6 x 6 of 400 points match, as if the pictures lay on each other.
  EXPECT_NEAR(Pair(0, 0, 0, 1, 30).Share(), 36 / 400.0, 0.01);
  EXPECT_NEAR(Pair(3.141592653589793, 0, 0, 1, 30).Share(), 36 / 400.0, 0.01);
}

TEST(OverlapShare, OddInput) {
  EXPECT_EQ(OverlapShare({}, {}, {}), 0);
  const std::vector<SeaPoint> one = {{5, 5, 1, 0}};
  EXPECT_EQ(OverlapShare(one, one, {{0, 0}}), 1);
  const std::vector<SeaPoint> same(10, {5, 5, 1, 0});
  EXPECT_EQ(OverlapShare(same, same, {{0, 0}, {1, 1}}), 0.2);
}

}  // namespace
}  // namespace colmap_seapoint
