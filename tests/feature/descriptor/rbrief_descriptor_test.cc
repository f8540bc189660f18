#include "feature/descriptor/rbrief_descriptor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "feature/descriptor/local_contrast.h"
#include "feature/descriptor/rbrief_pattern.h"
#include "feature/matching/hamming_matcher.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

constexpr int kSize = 181;  // both scales of tests lie inside
constexpr int kMiddle = 90;
constexpr double kCenter = 90.5;  // centre of the middle pixel

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

// Turning the picture by any angle is turning its descriptor by the nearest number of steps, and
// the centroid's orientation turns along.
TEST(RBriefTest, TurnedPictureHasTheTurnedDescriptor) {
  std::vector<double> errors_deg;
  for (int n = 0; n < 12; ++n) {
    const Described upright = Describe(Patch(n, 0));
    for (const double angle_deg : {1.0, 10.0, 33.0, 45.0, 77.0, 123.0, -60.0, 200.0, 305.0}) {
      const double angle = angle_deg * M_PI / 180;
      const Described turned = Describe(Patch(n, angle));
      const int steps = static_cast<int>(std::lround(angle / kTurnStep));
      EXPECT_LT(HammingDistance(TurnDescriptor(upright.descriptor, steps), turned.descriptor), 48)
          << n << " by " << angle_deg;
      errors_deg.push_back(AngleBetween(turned.orientation - upright.orientation, angle) * 180 /
                           M_PI);
    }
  }
  std::sort(errors_deg.begin(), errors_deg.end());
  EXPECT_LT(errors_deg[errors_deg.size() / 2], 2.5);
}

// Quarter turns map pixels on pixels. Only at half size they do not: there the point's pixel moves
// by one when the point lies left or right of the pixel's middle.
TEST(RBriefTest, QuarterTurnsChangeLittle) {
  for (int n = 0; n < 12; ++n) {
    const Described upright = Describe(Patch(n, 0));
    for (int quarter = 1; quarter < 4; ++quarter) {
      const double angle = quarter * M_PI / 2;
      const Described turned = Describe(Patch(n, angle));
      const Descriptor expected = TurnDescriptor(upright.descriptor, 8 * quarter);
      int fine_distance = 0;
      for (size_t byte = 0; byte < kFirstCoarseTest / 8; ++byte) {
        fine_distance +=
            __builtin_popcount(static_cast<unsigned>(expected[byte] ^ turned.descriptor[byte]));
      }
      EXPECT_LE(fine_distance, 6) << n << " " << quarter;
      EXPECT_LE(HammingDistance(expected, turned.descriptor), 24) << n << " " << quarter;
      EXPECT_LT(AngleBetween(turned.orientation - upright.orientation, angle), 0.01);
    }
  }
}

TEST(RBriefTest, TurnsOfDescriptorsAddUp) {
  const Descriptor descriptor = Describe(Patch(3, 0)).descriptor;
  EXPECT_EQ(TurnDescriptor(descriptor, 0), descriptor);
  EXPECT_EQ(TurnDescriptor(descriptor, kNumTurns), descriptor);
  for (int turns = 1; turns < kNumTurns; ++turns) {
    EXPECT_NE(TurnDescriptor(descriptor, turns), descriptor);
    EXPECT_EQ(TurnDescriptor(TurnDescriptor(descriptor, turns), -turns), descriptor) << turns;
    EXPECT_EQ(TurnDescriptor(TurnDescriptor(descriptor, 5), turns),
              TurnDescriptor(descriptor, turns + 5));
  }
}

TEST(RBriefTest, BlindToBrightness) {
  for (int n = 0; n < 12; ++n) {
    const Described plain = Describe(Patch(n, 0.2));
    const Described brighter = Describe(Patch(n, 0.2, 1, 17));
    EXPECT_LE(HammingDistance(plain.descriptor, brighter.descriptor), 3);  // rounding
    EXPECT_LT(AngleBetween(plain.orientation, brighter.orientation), 0.001);
    const Described dimmed = Describe(Patch(n, 0.2, 0.5, 30));
    EXPECT_LE(HammingDistance(plain.descriptor, dimmed.descriptor), 12);
    EXPECT_LT(AngleBetween(plain.orientation, dimmed.orientation), 0.03);
    const Described negative = Describe(Patch(n, 0.2, -1, 255));
    EXPECT_NEAR(AngleBetween(plain.orientation, negative.orientation), M_PI, 0.01);
  }
}

// A bright spot beside the point is where its orientation points: to the right 0, down +90 degrees.
TEST(RBriefTest, OrientationPointsToTheBrightSide) {
  for (double angle = -3; angle <= 3; angle += 0.5) {
    const double spot_x = kCenter + 8 * std::cos(angle), spot_y = kCenter + 8 * std::sin(angle);
    GrayImage spot(kSize, kSize);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const double squared = std::pow(x + 0.5 - spot_x, 2) + std::pow(y + 0.5 - spot_y, 2);
        spot.At(x, y) = static_cast<uint8_t>(std::lround(20 + 200 * std::exp(-squared / 18)));
      }
    }
    EXPECT_LT(AngleBetween(Describe(spot).orientation, angle), 0.03) << angle;
  }
}

// A bit is set where the first point of its test has less contrast than the second: the first half
// of the tests on the picture, the others on its half.
TEST(RBriefTest, BitsAreTheComparisonsOfThePattern) {
  const GrayImage picture = Patch(4, 0.3);
  GrayImage half(kSize / 2, kSize / 2);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      half.At(x, y) = static_cast<uint8_t>(
          (picture.At(2 * x, 2 * y) + picture.At(2 * x + 1, 2 * y) + picture.At(2 * x, 2 * y + 1) +
           picture.At(2 * x + 1, 2 * y + 1) + 2) /
          4);
    }
  }
  const Image<int16_t> fine = LocalContrast(picture), coarse = LocalContrast(half);
  const Descriptor descriptor = Describe(picture).descriptor;
  for (size_t bit = 0; bit < 256; ++bit) {
    const RBriefTest& test = RBriefPattern()[bit];
    auto contrast = [&](const std::array<int8_t, 2>& offset) {
      return bit < kFirstCoarseTest ? fine.At(kMiddle + offset[0], kMiddle + offset[1])
                                    : coarse.At(kMiddle / 2 + offset[0], kMiddle / 2 + offset[1]);
    };
    const bool expected = contrast(test.first) < contrast(test.second);
    EXPECT_EQ(descriptor[bit / 8] >> (bit % 8) & 1, expected ? 1 : 0) << bit;
  }
}

TEST(RBriefTest, PatternKeepsItsPromises) {
  std::set<std::array<int, 5>> seen;
  const auto& pattern = RBriefPattern();
  for (size_t bit = 0; bit < 256; ++bit) {
    const RBriefTest& test = pattern[bit];
    for (const auto& point : {test.first, test.second}) {
      EXPECT_LE(std::hypot(point[0], point[1]), kPatternRadius + 0.5);
    }
    EXPECT_NE(test.first, test.second) << bit;
    seen.insert(
        {bit < kFirstCoarseTest, test.first[0], test.first[1], test.second[0], test.second[1]});
    // Eight steps are a quarter turn: (x, y) -> (-y, x), exactly.
    const RBriefTest& quarter = pattern[bit / 32 * 32 + (bit + 8) % 32];
    EXPECT_EQ(quarter.first[0], -test.first[1]);
    EXPECT_EQ(quarter.first[1], test.first[0]);
    EXPECT_EQ(quarter.second[0], -test.second[1]);
    EXPECT_EQ(quarter.second[1], test.second[0]);
  }
  EXPECT_EQ(seen.size(), 256u);
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
  EXPECT_EQ(hash, 1331209149u);
}

// A large picture is described from its half: the same scene at twice the size has the same
// descriptors, but for what rounding to whole grey levels does.
TEST(RBriefTest, LargePicturesAreDescribedAtReducedSize) {
  EXPECT_EQ(DescriptionReduction(GrayImage(2000, 2000)), 1);
  EXPECT_EQ(DescriptionReduction(GrayImage(2001, 2000)), 2);
  EXPECT_EQ(DescriptionReduction(GrayImage(4000, 3000)), 2);
  EXPECT_EQ(DescriptionReduction(GrayImage(6000, 4000)), 4);
  const NoiseTexture texture(9, 14, 3);
  GrayImage small(1100, 950), large(2200, 1900);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      small.At(x, y) = static_cast<uint8_t>(127 + 90 * texture.At({x + 0.5, y + 0.5, 0.5}) / 2);
      for (int i = 0; i < 4; ++i) large.At(2 * x + i % 2, 2 * y + i / 2) = small.At(x, y);
    }
  }
  std::vector<SeaPoint> small_points(3), large_points(3);
  const float places[3][2] = {{400.5f, 300.5f}, {20.5f, 25.5f}, {1080.5f, 930.5f}};
  for (size_t i = 0; i < 3; ++i) {
    small_points[i].x = places[i][0];
    small_points[i].y = places[i][1];
    large_points[i].x = 2 * places[i][0];
    large_points[i].y = 2 * places[i][1];
  }
  EXPECT_EQ(DescribeSeaPoints(small, &small_points), DescribeSeaPoints(large, &large_points));
}

TEST(RBriefTest, NoPointsNoDescriptors) {
  std::vector<SeaPoint> points;
  EXPECT_TRUE(DescribeSeaPoints(GrayImage(), &points).empty());
}

}  // namespace
}  // namespace colmap_seapoint
