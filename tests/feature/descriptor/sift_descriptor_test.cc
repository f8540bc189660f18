#include "feature/descriptor/sift_descriptor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

#include "feature/descriptor/rbrief_descriptor.h"
#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

constexpr int kSize = 160;  // even: quarter turns map the halved picture's pixels on pixels
constexpr int kNumPlaces = 12;

using LightAt = std::function<double(double x, double y, double level)>;

// The texture around place `n`, moved by (dx, dy), seen in some light.
GrayImage Patch(int n, double dx = 0, double dy = 0, const LightAt& light = {}) {
  const NoiseTexture texture(9, 14, 3);
  GrayImage picture(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      double level = 127 + 70 * texture.At({x - dx + 1000.0 * n, y - dy, 0.5});
      level = std::clamp(level, 20.0, 235.0);
      if (light) level = light(x, y, level);
      picture.At(x, y) = static_cast<uint8_t>(std::lround(level));
    }
  }
  return picture;
}

SiftDescriptor Describe(const GrayImage& picture, double x, double y) {
  std::vector<SeaPoint> points(1);
  points[0].x = static_cast<float>(x);
  points[0].y = static_cast<float>(y);
  const std::vector<SiftDescriptor> descriptors = DescribeBySift(picture, points);
  EXPECT_EQ(descriptors.size(), 1u);
  return descriptors.front();
}

// The angle between two descriptors, whatever rounding has made of their lengths.
double Angle(const SiftDescriptor& a, const SiftDescriptor& b) {
  double aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    aa += a[i] * a[i];
    bb += b[i] * b[i];
    ab += a[i] * b[i];
  }
  return std::acos(std::min(1.0, ab / std::sqrt(aa * bb)));
}

// The angle between descriptors of one place must be far below that between different places.
double SmallestBetweenPlaces() {
  std::vector<SiftDescriptor> all;
  for (int n = 0; n < kNumPlaces; ++n) all.push_back(Describe(Patch(n), 80, 80));
  double smallest = 2;
  for (size_t i = 0; i < all.size(); ++i) {
    for (size_t j = i + 1; j < all.size(); ++j) {
      smallest = std::min(smallest, Angle(all[i], all[j]));
    }
  }
  return smallest;
}

TEST(SiftDescriptorTest, DifferentPlacesDiffer) { EXPECT_GT(SmallestBetweenPlaces(), 0.35); }

// COLMAP's own form: the length of a RootSIFT is 512, but for rounding.
TEST(SiftDescriptorTest, LengthIs512) {
  for (int n = 0; n < kNumPlaces; ++n) {
    double squared = 0;
    for (const uint8_t value : Describe(Patch(n), 80, 80)) squared += value * value;
    EXPECT_NEAR(std::sqrt(squared), 512, 4);
  }
}

TEST(SiftDescriptorTest, LightHardlyMatters) {
  const std::vector<LightAt> lights = {
      [](double, double, double level) { return 0.4 * level + 90; },                  // haze
      [](double, double, double level) { return 255 * std::pow(level / 255, 1.8); },  // gamma
      [](double x, double y, double level) {                                          // a lamp
        return level * (0.3 + 0.7 * std::exp(-(x * x + y * y) / (2 * 90 * 90)));
      }};
  for (int n = 0; n < kNumPlaces; ++n) {
    const SiftDescriptor usual = Describe(Patch(n), 80, 80);
    for (size_t i = 0; i < lights.size(); ++i) {
      EXPECT_LT(Angle(usual, Describe(Patch(n, 0, 0, lights[i]), 80, 80)), 0.15)
          << n << " in light " << i;
    }
  }
}

// OpenCV describes around the nearest whole pixel of the halved picture.
TEST(SiftDescriptorTest, MovesWithThePicture) {
  for (int n = 0; n < kNumPlaces; ++n) {
    const SiftDescriptor here = Describe(Patch(n), 81, 81);
    EXPECT_LT(Angle(here, Describe(Patch(n, 6, -4), 87, 77)), 0.03);     // whole pixels of it
    EXPECT_LT(Angle(here, Describe(Patch(n, 3.3, 5), 84.3, 86)), 0.15);  // and parts of them
    EXPECT_GT(Angle(here, Describe(Patch(n, 6, -4), 81, 81)), 0.15);
  }
}

GrayImage TurnQuarters(const GrayImage& picture, int quarters) {
  GrayImage turned = picture;
  for (int i = 0; i < quarters; ++i) {
    const GrayImage before = turned;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) turned.At(kSize - 1 - y, x) = before.At(x, y);
    }
  }
  return turned;
}

TEST(SiftDescriptorTest, QuarterTurnsAreExact) {
  for (int n = 0; n < kNumPlaces; ++n) {
    const GrayImage picture = Patch(n);
    double x = 70.4, y = 85.1;
    const SiftDescriptor upright = Describe(picture, x, y);
    for (int quarters = 1; quarters < 4; ++quarters) {
      std::tie(x, y) = std::make_pair(kSize - y, x);
      const SiftDescriptor turned = Describe(TurnQuarters(picture, quarters), x, y);
      EXPECT_LT(Angle(TurnSiftDescriptor(upright, quarters), turned), 0.01);
      EXPECT_LT(Angle(TurnSiftDescriptor(upright, quarters - 4), turned), 0.01);
      EXPECT_GT(Angle(upright, turned), 0.3);
    }
    EXPECT_EQ(TurnSiftDescriptor(upright, 4), upright);
  }
}

// Beyond 4 megapixels the picture is described at half its size: every pixel fourfold, the same.
TEST(SiftDescriptorTest, LargePicturesAreReduced) {
  const NoiseTexture texture(9, 14, 3);
  GrayImage small(1100, 1000), large(2200, 2000);
  for (int y = 0; y < large.height; ++y) {
    for (int x = 0; x < large.width; ++x) {
      uint8_t& level = small.At(x / 2, y / 2);
      if (x % 2 == 0 && y % 2 == 0) {
        const double value = 127 + 70 * texture.At({x / 2 + 0.5, y / 2 + 0.5, 0.5});
        level = static_cast<uint8_t>(std::clamp(value, 20.0, 235.0));
      }
      large.At(x, y) = level;
    }
  }
  ASSERT_EQ(DescriptionReduction(small), 1);
  ASSERT_EQ(DescriptionReduction(large), 2);
  EXPECT_LT(Angle(Describe(small, 500.6, 301), Describe(large, 1001.2, 602)), 0.01);
}

TEST(SiftDescriptorTest, EdgesAndFlatPictures) {
  EXPECT_TRUE(DescribeBySift(Patch(0), {}).empty());
  Describe(Patch(0), kRBriefBorder, kSize - kRBriefBorder);
  EXPECT_EQ(Describe(GrayImage(kSize, kSize, 1, 90), 80, 80), SiftDescriptor{});
  EXPECT_EQ(Describe(GrayImage(33, 35, 1, 90), 16, 16), SiftDescriptor{});
}

}  // namespace
}  // namespace colmap_seapoint
