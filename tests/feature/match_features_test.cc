#include "feature/match_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "feature/extract_features.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

constexpr int kSize = 320;

// A window on one ground, its middle moved by 20 pixels a step, turned about itself, and the darker
// the further it moved.
Features Extract(int step, double angle_deg, const std::string& descriptor) {
  const NoiseTexture texture(5, 24, 4);
  const double angle = angle_deg * M_PI / 180;
  GrayImage picture(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double dx = x + 0.5 - kSize / 2.0, dy = y + 0.5 - kSize / 2.0;
      const double u = std::cos(angle) * dx + std::sin(angle) * dy + 20.0 * step;
      const double v = -std::sin(angle) * dx + std::cos(angle) * dy;
      const double value = 127 + 90 * texture.At({u, v, 0.3});
      picture.At(x, y) =
          static_cast<uint8_t>(255 * std::pow(std::clamp(value / 255, 0.0, 1.0), 1 + 0.5 * step));
    }
  }
  SeaPointExtractionOptions options;
  options.min_num_features = 300;
  options.max_num_features = 400;
  options.num_levels = 2;
  options.descriptor = descriptor;
  return ExtractFeatures(picture, GrayImage(), options).features;
}

// With these hardly anything can be matched by SIFT (or by rBRIEF).
SeaPointMatchingOptions WithoutSift() {
  SeaPointMatchingOptions options;
  options.sift.max_distance = 0;
  return options;
}
SeaPointMatchingOptions WithoutRBrief() {
  SeaPointMatchingOptions options;
  options.hamming.max_distance = 0;
  return options;
}

TEST(MatchFeaturesTest, SiftComesOnTopOfRBrief) {
  const Features sift = Extract(0, 0, "sift"), rbrief = Extract(0, 0, "rbrief");
  EXPECT_EQ(sift.descriptors, rbrief.descriptors);
  EXPECT_EQ(sift.sift_descriptors.size(), sift.points.size());
  EXPECT_TRUE(rbrief.sift_descriptors.empty());
}

TEST(MatchFeaturesTest, SiftMatchesTwoPicturesThatHaveIt) {
  for (const double angle_deg : {0.0, 90.0, 180.0, 270.0}) {
    const Features a = Extract(0, 0, "sift"), b = Extract(1, angle_deg, "sift");
    const FeatureMatches matches = MatchSeaPoints(a, b, SeaPointMatchingOptions());
    EXPECT_GT(matches.size(), a.points.size() / 3) << angle_deg;
    EXPECT_EQ(MatchSeaPoints(a, b, WithoutRBrief()), matches) << angle_deg;
    EXPECT_LT(MatchSeaPoints(a, b, WithoutSift()).size(), matches.size() / 2) << angle_deg;
    const double angle = angle_deg * M_PI / 180;
    size_t num_right = 0;
    for (const FeatureMatch& match : matches) {
      const double u = a.points[match.idx1].x - kSize / 2.0 - 20;
      const double v = a.points[match.idx1].y - kSize / 2.0;
      const double x = std::cos(angle) * u - std::sin(angle) * v + kSize / 2.0;
      const double y = std::sin(angle) * u + std::cos(angle) * v + kSize / 2.0;
      num_right += std::hypot(b.points[match.idx2].x - x, b.points[match.idx2].y - y) < 3;
    }
    EXPECT_GT(num_right, matches.size() * 95 / 100) << angle_deg;
  }
}

TEST(MatchFeaturesTest, RBriefMatchesMixedPairs) {
  const Features a = Extract(0, 0, "sift"), b = Extract(1, 0, "sift");
  const Features plain_a = Extract(0, 0, "rbrief"), plain_b = Extract(1, 0, "rbrief");
  const SeaPointMatchingOptions options;
  const FeatureMatches expected = MatchSeaPoints(plain_a, plain_b, options);
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(MatchSeaPoints(a, plain_b, options), expected);
  EXPECT_EQ(MatchSeaPoints(plain_a, b, options), expected);
  EXPECT_EQ(MatchSeaPoints(a, plain_b, WithoutSift()), expected);
  EXPECT_LT(MatchSeaPoints(a, plain_b, WithoutRBrief()).size(), expected.size() / 2);
}

// An upright SIFT is worth nothing there.
TEST(MatchFeaturesTest, RBriefMatchesTurnedPairs) {
  for (const double angle_deg : {22.5, 45.0, 120.0}) {
    const Features a = Extract(0, 0, "sift"), b = Extract(1, angle_deg, "sift");
    const FeatureMatches matches = MatchSeaPoints(a, b, SeaPointMatchingOptions());
    EXPECT_GT(matches.size(), 100u) << angle_deg;
    EXPECT_EQ(MatchSeaPoints(a, b, WithoutSift()), matches) << angle_deg;
  }
}

}  // namespace
}  // namespace colmap_seapoint
