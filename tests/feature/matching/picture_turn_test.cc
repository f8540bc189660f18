#include "feature/matching/picture_turn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "feature/descriptor/rbrief_descriptor.h"
#include "feature/descriptor/rbrief_pattern.h"
#include "feature/extract_features.h"
#include "feature/match_features.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 420, kHeight = 360;

// A textured plane seen from straight above: turned about the picture's middle (from x towards y),
// then shifted.
GrayImage View(double angle, double shift_x, double shift_y) {
  const NoiseTexture texture(21, 9, 4);
  GrayImage picture(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double dx = x + 0.5 - kWidth / 2.0 - shift_x, dy = y + 0.5 - kHeight / 2.0 - shift_y;
      const double u = std::cos(angle) * dx + std::sin(angle) * dy;
      const double v = -std::sin(angle) * dx + std::cos(angle) * dy;
      picture.At(x, y) =
          static_cast<uint8_t>(std::clamp(127 + 90 * texture.At({u, v, 0.5}), 0., 255.));
    }
  }
  return picture;
}

Features Extract(const GrayImage& picture) {
  SeaPointExtractionOptions options;
  options.min_num_features = 500;
  options.max_num_features = 600;
  return ExtractFeatures(picture, GrayImage(), options).features;
}

int StepsBetween(int a, int b) {
  const int difference = std::abs(a - b) % kNumTurns;
  return std::min(difference, kNumTurns - difference);
}

// Every turn is found to the nearest step (or the next but where it lies between two), and most
// points are matched at any of them.
TEST(PictureTurnTest, EveryTurnIsFoundAndMatched) {
  const Features upright = Extract(View(0, 0, 0));
  for (int angle_deg = 0; angle_deg < 360; angle_deg += 19) {
    const double angle = angle_deg * M_PI / 180;
    const Features turned = Extract(View(angle, 25, -14));
    const int expected = static_cast<int>(std::lround(angle / kTurnStep)) % kNumTurns;
    EXPECT_LE(StepsBetween(FindPictureTurn(upright, turned), expected), 1) << angle_deg;
    const FeatureMatches matches = MatchSeaPoints(upright, turned, SeaPointMatchingOptions());
    size_t num_right = 0;
    for (const FeatureMatch& match : matches) {
      const SeaPoint& from = upright.points[match.idx1];
      const SeaPoint& to = turned.points[match.idx2];
      const double dx = from.x - kWidth / 2.0, dy = from.y - kHeight / 2.0;
      const double x = kWidth / 2.0 + 25 + std::cos(angle) * dx - std::sin(angle) * dy;
      const double y = kHeight / 2.0 - 14 + std::sin(angle) * dx + std::cos(angle) * dy;
      num_right += std::hypot(to.x - x, to.y - y) < 2;
    }
    EXPECT_GE(matches.size(), upright.points.size() * 35 / 100) << angle_deg;
    EXPECT_GE(num_right, matches.size() * 97 / 100) << angle_deg;
  }
}

TEST(PictureTurnTest, SwappedPicturesAreTurnedBack) {
  const Features a = Extract(View(0, 0, 0)), b = Extract(View(2.1, 10, 5));
  const int forth = FindPictureTurn(a, b), back = FindPictureTurn(b, a);
  EXPECT_LE(StepsBetween(forth + back, 0), 1) << forth << " " << back;
}

TEST(PictureTurnTest, CoarseLevelsVoteToo) {
  SeaPointExtractionOptions options;
  options.min_num_features = 500;
  options.max_num_features = 600;
  options.num_levels = 3;
  const Features upright = ExtractFeatures(View(0, 0, 0), GrayImage(), options).features;
  const Features turned = ExtractFeatures(View(M_PI, 0, 0), GrayImage(), options).features;
  EXPECT_EQ(FindPictureTurn(upright, turned), kNumTurns / 2);
}

TEST(PictureTurnTest, NothingSpeaksForATurn) {
  EXPECT_EQ(FindPictureTurn(Features(), Features()), 0);
  Features one;
  one.points.resize(1);
  one.descriptors.resize(1);
  EXPECT_EQ(FindPictureTurn(one, Features()), 0);
  EXPECT_EQ(FindPictureTurn(Features(), one), 0);
  EXPECT_EQ(FindPictureTurn(one, one), 0);
}

}  // namespace
}  // namespace colmap_seapoint
