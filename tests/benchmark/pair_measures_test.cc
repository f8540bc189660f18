#include "examples/benchmarks/feature/pair_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace colmap_seapoint {
namespace {

TEST(MedianTest, OddEvenAndMissing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Median({5, 1, 3}), 3);
  EXPECT_EQ(Median({4, 1, 3, 2}), 2.5);
  EXPECT_EQ(Median({nan, 7, nan, 9, 1}), 7);
  EXPECT_TRUE(std::isnan(Median({})));
  EXPECT_TRUE(std::isnan(Median({nan})));
}

TEST(MatchedShareTest, IsOverTheSmallerNumber) {
  EXPECT_EQ(MatchedShare(30, 60, 100), 0.5);
  EXPECT_EQ(MatchedShare(30, 100, 60), 0.5);
  EXPECT_EQ(MatchedShare(0, 0, 100), 0);
}

TEST(MatchedAreaTest, IsTheUnionOfDiscs) {
  const CellGrid grid(1000, 800, 1);
  // The first two lie at one place, the last is not matched.
  const std::vector<SeaPoint> points = {{300, 300}, {300, 300}, {700, 400}, {500, 700}};
  const double disc = std::acos(-1.0) * 50 * 50 / (1000.0 * 800.0);
  const auto area = [&](const FeatureMatches& matches) {
    return MatchedArea(grid, 10, points, matches, 50).OverlapRate();
  };
  EXPECT_EQ(area({}), 0);
  EXPECT_NEAR(area({{9, 0}}), disc, 0.005 * disc);
  EXPECT_EQ(area({{9, 0}, {3, 1}}), area({{9, 0}}));
  EXPECT_NEAR(area({{9, 0}, {3, 1}, {0, 2}}), 2 * disc, 0.01 * disc);
}

TEST(MatchedAreaTest, HalfOfADiscOnTheBorderCounts) {
  const CellGrid grid(1000, 800, 1);
  const double half_disc = 0.5 * std::acos(-1.0) * 50 * 50 / (1000.0 * 800.0);
  EXPECT_NEAR(MatchedArea(grid, 1, {{0, 400}}, {{0, 0}}, 50).OverlapRate(), half_disc,
              0.01 * half_disc);
}

// Grey 100 with noise; from column 200 on with stripes, too.
GrayImage NoisyHalf(double noise, double amplitude) {
  GrayImage picture(400, 320);
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, noise);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double stripes = x < 200 ? 0 : amplitude * ((y / 4) % 2 == 0 ? 1 : -1);
      picture.At(x, y) = static_cast<uint8_t>(std::lround(100 + stripes + normal(random)));
    }
  }
  return picture;
}

TEST(TextureTest, IsWhatRisesAboveTheNoise) {
  const CellGrid grid(400, 320, 8);
  const Texture texture = FindTexture(NoisyHalf(3, 20), grid);
  EXPECT_GT(texture.noise, 0.7 * 3);  // a low percentile lies somewhat below the mean
  EXPECT_LT(texture.noise, 3);
  EXPECT_EQ(texture.limit, 3 * texture.noise);
  ASSERT_EQ(texture.textured.size(), grid.Size());
  for (size_t cell = 0; cell < grid.Size(); ++cell) {
    EXPECT_EQ(texture.textured[cell], grid.Center(cell).x() < 200 ? 0 : 1) << cell;
  }
}

TEST(TextureTest, AGreyLevelMoreOrLessIsNone) {
  const Texture texture = FindTexture(NoisyHalf(0.2, 1), CellGrid(400, 320, 8));
  EXPECT_EQ(texture.limit, 1.5);
  EXPECT_EQ(std::count(texture.textured.begin(), texture.textured.end(), 1), 0);
}

}  // namespace
}  // namespace colmap_seapoint
