#include "feature/detector/local_maxima.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <string>

#include "feature/detector/seapoint_detector.h"
#include "tests/feature/detector/detector_oracle.h"
#include "tests/synthetic/world.h"
#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

using Generator = std::mt19937;

int Between(int low, int high, Generator* generator) {
  return low + static_cast<int>((*generator)() % static_cast<unsigned>(high - low + 1));
}

// Noise, black-and-white noise, flat, squares (equal measures), lone dots, a ramp with noise.
GrayImage AnyPicture(int width, int height, int kind, Generator* generator) {
  GrayImage picture(width, height);
  const int side = Between(1, 9, generator), level = Between(0, 255, generator);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const unsigned noise = (*generator)();
      const unsigned values[] = {noise,
                                 noise % 2 * 255,
                                 static_cast<unsigned>(level),
                                 (x / side + y / side) % 2 == 0 ? 255u : 0u,
                                 noise % 97 == 0 ? 255u : 0u,
                                 static_cast<unsigned>(x + 2 * y) + noise % 8};
      picture.At(x, y) = static_cast<uint8_t>(values[kind]);
    }
  }
  return picture;
}

GrayImage AnyMask(int width, int height, Generator* generator) {
  if (Between(0, 2, generator) == 0) return GrayImage();
  GrayImage mask(width, height);
  for (uint8_t& value : mask.data) value = static_cast<uint8_t>((*generator)() % 3 * 100);
  return mask;
}

void ExpectSame(const LocalMaxima& actual, const LocalMaxima& expected) {
  EXPECT_EQ(actual.lowest, expected.lowest);
  EXPECT_EQ(actual.highest, expected.highest);
  ASSERT_EQ(actual.maxima.size(), expected.maxima.size());
  for (size_t i = 0; i < actual.maxima.size(); ++i) {
    ASSERT_EQ(actual.maxima[i].x, expected.maxima[i].x) << i;
    ASSERT_EQ(actual.maxima[i].y, expected.maxima[i].y) << i;
    ASSERT_EQ(std::memcmp(actual.maxima[i].around, expected.maxima[i].around,
                          sizeof(actual.maxima[i].around)),
              0)
        << i;
  }
}

// The picture through every instruction set and in 1 to many bands, against the oracle.
size_t CheckPicture(const GrayImage& picture, const GrayImage& mask, const HarrisOptions& options,
                    int radius, int border) {
  const LocalMaxima expected =
      OracleLocalMaxima(OracleHarrisMeasure(picture, options), mask, radius, border);
  ForEachVectorTarget(
      [&] { ExpectSame(FindLocalMaxima(picture, mask, options, radius, border, 1), expected); });
  for (const int num_threads : {2, 3, 7, 1000}) {
    SCOPED_TRACE(std::to_string(num_threads) + " threads");
    ExpectSame(FindLocalMaxima(picture, mask, options, radius, border, num_threads), expected);
  }
  return expected.maxima.size();
}

TEST(LocalMaximaTest, EqualsTheOracleBitForBit) {
  Generator generator(1);
  size_t total = 0;
  for (int round = 0; round < 300; ++round) {
    const HarrisOptions options = {Between(0, 8, &generator) / 2.0,
                                   2 * Between(1, 5, &generator) + 1,
                                   Between(0, 5, &generator) * 0.05};
    const int harris_border = HarrisBorder(options);
    // Half of them only just wider or higher than twice the border: narrower than a vector.
    const int spare_x = Between(1, round % 2 == 0 ? 12 : 150, &generator);
    const int spare_y = Between(1, round % 4 < 2 ? 8 : 100, &generator);
    const GrayImage picture =
        AnyPicture(2 * harris_border + spare_x, 2 * harris_border + spare_y, round % 6, &generator);
    const GrayImage mask = AnyMask(picture.width, picture.height, &generator);
    const int radius = Between(1, round % 3 == 0 ? 20 : 3, &generator);
    const int border = harris_border + 1 + Between(0, 3, &generator) % 3;
    SCOPED_TRACE("round " + std::to_string(round));
    total += CheckPicture(picture, mask, options, radius, border);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(total, 1000u);
}

TEST(LocalMaximaTest, FromOnePixelUp) {
  Generator generator(2);
  const HarrisOptions options = {0, 3, 0.04};
  const int border = HarrisBorder(options) + 1;
  size_t total = 0;
  for (int width = 1; width < 40; width += 1 + width / 8) {
    for (int height = 1; height < 24; height += 1 + height / 8) {
      SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height));
      total +=
          CheckPicture(AnyPicture(width, height, 0, &generator), GrayImage(), options, 1, border);
    }
  }
  EXPECT_GT(total, 100u);
}

TEST(LocalMaximaTest, WindowWiderThanThePicture) {
  Generator generator(3);
  const GrayImage picture = AnyPicture(70, 50, 0, &generator);
  EXPECT_EQ(CheckPicture(picture, GrayImage(), {1, 5, 0.04}, 100, 8), 1u);
}

// Pictures of the synthetic world: what the detector is for. Whole detector, bit for bit: every
// instruction set and any number of threads against each other, all against the paper.
TEST(LocalMaximaTest, PicturesOfTheWorld) {
  const World world = SlantedWorld(3, 15);
  for (const double turn_deg : {0.0, 25.0}) {
    const Viewpoint view =
        StandAt(MildCamera(CameraModel::kOpenCV, 260, 321, 243), {0, 0, 0}, {0, 0, turn_deg});
    const GrayImage picture = LumaOf(TakePicture(world, view));
    for (const double sigma : {1.0, 2.0}) {
      const HarrisOptions harris = {sigma, 7, 0.04};
      EXPECT_GT(CheckPicture(picture, GrayImage(), harris, 3, 12), 100u);
      SeaPointExtractionOptions options;
      options.light_balance = 0;  // the paper
      options.smoothing_sigma = sigma;
      options.nms_radius = 3;
      options.min_num_features = 80;
      options.max_num_features = 100;
      const auto points = DetectSeaPoints(picture, GrayImage(), options, 12).points;
      const auto expected = OracleDetect(picture, GrayImage(), options, 12);
      ASSERT_EQ(points.size(), expected.size());
      for (size_t i = 0; i < points.size(); ++i) {
        EXPECT_NEAR(points[i].x, expected[i].x, 1e-4);
        EXPECT_NEAR(points[i].y, expected[i].y, 1e-4);
      }
      auto same = [&](int num_threads) {
        const auto again = DetectSeaPoints(picture, GrayImage(), options, 12, num_threads).points;
        ASSERT_EQ(again.size(), points.size());
        EXPECT_EQ(std::memcmp(again.data(), points.data(), points.size() * sizeof(SeaPoint)), 0);
      };
      ForEachVectorTarget([&] { same(1); });
      for (const int num_threads : {2, 5}) same(num_threads);
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
