#include "feature/rbrief_descriptor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "feature/hamming_matcher.h"
#include "feature/rbrief_pattern.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

constexpr int kSize = 81;
constexpr double kCenter = 40.5;  // centre of pixel 40

// The texture around place `n`, turned by `angle` about the middle pixel's centre: grey levels 20
// to 235, computed at every pixel, not resampled.
GrayImage Patch(int n, double angle, double gain = 1, double offset = 0) {
  const NoiseTexture texture(9, 14, 3);
  GrayImage picture(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double dx = x + 0.5 - kCenter, dy = y + 0.5 - kCenter;
      const double u = std::cos(angle) * dx + std::sin(angle) * dy;
      const double v = -std::sin(angle) * dx + std::cos(angle) * dy;
      const double value = texture.At({u + 1000.0 * n, v, 0.5});
      const double level = std::clamp(127 + 70 * value, 20.0, 235.0);
      picture.At(x, y) = static_cast<uint8_t>(std::lround(gain * level + offset));
    }
  }
  return picture;
}

struct Described {
  Descriptor descriptor;
  double orientation;
};

Described Describe(const GrayImage& picture) {
  std::vector<SeaPoint> points(1);
  points[0].x = points[0].y = static_cast<float>(kCenter);
  const std::vector<Descriptor> descriptors = DescribeSeaPoints(picture, &points);
  EXPECT_EQ(descriptors.size(), 1u);
  return {descriptors[0], points[0].orientation};
}

double AngleBetween(double a, double b) { return std::abs(std::remainder(a - b, 2 * M_PI)); }

TEST(RBriefTest, DifferentPlacesDifferByAboutHalf) {
  std::vector<Described> all;
  for (int n = 0; n < 30; ++n) all.push_back(Describe(Patch(n, 0)));
  double sum = 0;
  int smallest = 256, count = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    for (size_t j = i + 1; j < all.size(); ++j) {
      const int distance = HammingDistance(all[i].descriptor, all[j].descriptor);
      sum += distance;
      smallest = std::min(smallest, distance);
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 128, 12);
  EXPECT_GT(smallest, 50);
}

TEST(RBriefTest, FollowsRotationsByAnyAngle) {
  std::vector<double> errors_deg;
  for (int n = 0; n < 12; ++n) {
    const Described upright = Describe(Patch(n, 0));
    for (const double angle_deg : {1.0, 10.0, 33.0, 45.0, 77.0, 123.0, -60.0, 200.0, 305.0}) {
      const double angle = angle_deg * M_PI / 180;
      const Described turned = Describe(Patch(n, angle));
      EXPECT_LT(HammingDistance(upright.descriptor, turned.descriptor), 36)
          << n << " by " << angle_deg;
      errors_deg.push_back(AngleBetween(turned.orientation - upright.orientation, angle) * 180 /
                           M_PI);
    }
  }
  std::sort(errors_deg.begin(), errors_deg.end());
  EXPECT_LT(errors_deg[errors_deg.size() / 2], 1);
  EXPECT_LT(errors_deg.back(), 7.5);  // where the centroid lies near the middle
}

// Quarter turns map pixels on pixels.
TEST(RBriefTest, QuarterTurnsChangeNextToNothing) {
  for (int n = 0; n < 12; ++n) {
    const Described upright = Describe(Patch(n, 0));
    for (int quarter = 1; quarter < 4; ++quarter) {
      const double angle = quarter * M_PI / 2;
      const Described turned = Describe(Patch(n, angle));
      EXPECT_LE(HammingDistance(upright.descriptor, turned.descriptor), 4) << n << " " << quarter;
      EXPECT_LT(AngleBetween(turned.orientation - upright.orientation, angle), 0.002);
    }
  }
}

TEST(RBriefTest, BlindToBrightness) {
  for (int n = 0; n < 12; ++n) {
    const Described plain = Describe(Patch(n, 0.2));
    const Described brighter = Describe(Patch(n, 0.2, 1, 17));
    EXPECT_EQ(brighter.descriptor, plain.descriptor);
    EXPECT_EQ(brighter.orientation, plain.orientation);
    const Described dimmed = Describe(Patch(n, 0.2, 0.5, 30));
    EXPECT_LE(HammingDistance(plain.descriptor, dimmed.descriptor), 12);
    EXPECT_LT(AngleBetween(plain.orientation, dimmed.orientation), 0.03);
    const Described negative = Describe(Patch(n, 0.2, -1, 255));
    EXPECT_NEAR(AngleBetween(plain.orientation, negative.orientation), M_PI, 0.01);
  }
}

// The direction in which a picture gets brighter is its orientation: to the right 0, down +90.
TEST(RBriefTest, OrientationPointsToTheBrightSide) {
  for (double angle = -3; angle <= 3; angle += 0.5) {
    GrayImage ramp(kSize, kSize);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const double along = std::cos(angle) * (x - 40) + std::sin(angle) * (y - 40);
        ramp.At(x, y) = static_cast<uint8_t>(std::lround(127 + 2 * along));
      }
    }
    EXPECT_LT(AngleBetween(Describe(ramp).orientation, angle), 0.01) << angle;
  }
}

// A bit is set where the first point of its test is darker than the second.
TEST(RBriefTest, BitsAreTheComparisonsOfThePattern) {
  GrayImage ramp(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) ramp.At(x, y) = static_cast<uint8_t>(3 * x);
  }
  const Descriptor descriptor = Describe(ramp).descriptor;
  const auto& pattern = RBriefPattern();
  for (size_t bit = 0; bit < 256; ++bit) {
    const bool expected = pattern[bit].first[0] < pattern[bit].second[0];
    EXPECT_EQ(descriptor[bit / 8] >> (bit % 8) & 1, expected ? 1 : 0) << bit;
  }
}

TEST(RBriefTest, PatternKeepsItsPromises) {
  std::set<std::array<int, 4>> seen;
  for (const RBriefTest& test : RBriefPattern()) {
    for (const auto& point : {test.first, test.second}) {
      EXPECT_LE(point[0] * point[0] + point[1] * point[1], kPatternRadius * kPatternRadius);
    }
    const int dx = test.first[0] - test.second[0], dy = test.first[1] - test.second[1];
    EXPECT_GT(dx * dx + dy * dy, 0);
    EXPECT_LE(dx * dx + dy * dy, kMaxTestLength * kMaxTestLength);
    seen.insert({test.first[0], test.first[1], test.second[0], test.second[1]});
  }
  EXPECT_EQ(seen.size(), 256u);
  EXPECT_GE(kRBriefBorder, kPatternRadius + 1);
}

// The descriptors of a database made on another machine must mean the same.
TEST(RBriefTest, PatternIsTheSameForEver) {
  uint32_t hash = 2166136261u;
  for (const RBriefTest& test : RBriefPattern()) {
    for (const auto& point : {test.first, test.second}) {
      for (const int8_t value : point) {
        hash = (hash ^ static_cast<uint8_t>(value)) * 16777619u;
      }
    }
  }
  EXPECT_EQ(hash, 4079510372u);
}

TEST(RBriefTest, NoPointsNoDescriptors) {
  std::vector<SeaPoint> points;
  EXPECT_TRUE(DescribeSeaPoints(GrayImage(), &points).empty());
}

}  // namespace
}  // namespace colmap_seapoint
