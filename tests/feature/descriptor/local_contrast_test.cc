#include "feature/descriptor/local_contrast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace colmap_seapoint {
namespace {

GrayImage RandomPicture(int width, int height, unsigned seed) {
  std::mt19937 generator(seed);
  GrayImage picture(width, height);
  for (uint8_t& level : picture.data) level = static_cast<uint8_t>(generator() % 256);
  return picture;
}

// The definition, in floating point: what is left of the picture, smoothed by three boxes of 5 in
// each direction, without the mean of the wide box.
double Contrast(const GrayImage& picture, int x, int y) {
  constexpr double kTaps[] = {1, 3, 6, 10, 15, 18, 19, 18, 15, 10, 6, 3, 1};
  auto smooth = [&](int cx, int cy) {
    double sum = 0;
    for (int v = -6; v <= 6; ++v) {
      for (int u = -6; u <= 6; ++u) {
        sum += kTaps[u + 6] * kTaps[v + 6] / 15625 *
               picture.At(std::clamp(cx + u, 0, picture.width - 1),
                          std::clamp(cy + v, 0, picture.height - 1));
      }
    }
    return sum;
  };
  const int length_x = std::min(2 * kContrastBoxRadius + 1, picture.width);
  const int length_y = std::min(2 * kContrastBoxRadius + 1, picture.height);
  const int x0 = std::clamp(x - length_x / 2, 0, picture.width - length_x);
  const int y0 = std::clamp(y - length_y / 2, 0, picture.height - length_y);
  double mean = 0;
  for (int v = y0; v < y0 + length_y; ++v) {
    for (int u = x0; u < x0 + length_x; ++u) mean += smooth(u, v) / (length_x * length_y);
  }
  return kContrastUnit * (smooth(x, y) - mean);
}

TEST(LocalContrastTest, IsSmoothedPictureLessItsLocalMean) {
  for (const auto& [width, height] : {std::pair(90, 75), std::pair(61, 61), std::pair(20, 100),
                                      std::pair(7, 5), std::pair(1, 1)}) {
    const GrayImage picture = RandomPicture(width, height, 5);
    const Image<int16_t> contrast = LocalContrast(picture);
    ASSERT_EQ(contrast.width, width);
    ASSERT_EQ(contrast.height, height);
    for (const double fx : {0.0, 0.2, 0.5, 0.9, 1.0}) {
      for (const double fy : {0.0, 0.4, 1.0}) {
        const int x = static_cast<int>(fx * (width - 1)), y = static_cast<int>(fy * (height - 1));
        EXPECT_NEAR(contrast.At(x, y), Contrast(picture, x, y), 2) << x << " " << y;
      }
    }
  }
}

TEST(LocalContrastTest, BlindToHazeAndNearlyToAGlow) {
  const GrayImage picture = RandomPicture(200, 150, 6);
  GrayImage dim(200, 150), hazy(200, 150), lit(200, 150);
  for (int y = 0; y < 150; ++y) {
    for (int x = 0; x < 200; ++x) {
      const int level = picture.At(x, y) / 4;
      dim.At(x, y) = static_cast<uint8_t>(level);
      hazy.At(x, y) = static_cast<uint8_t>(level + 120);
      lit.At(x, y) = static_cast<uint8_t>(level + x / 2);
    }
  }
  const Image<int16_t> expected = LocalContrast(dim);
  const Image<int16_t> haze = LocalContrast(hazy);
  for (size_t i = 0; i < haze.data.size(); ++i) {
    EXPECT_NEAR(haze.data[i], expected.data[i], 2);  // of 15 steps a grey level: rounding
  }
  const Image<int16_t> glow = LocalContrast(lit);
  for (int y = 40; y < 110; ++y) {
    for (int x = 40; x < 160; ++x) EXPECT_NEAR(glow.At(x, y), expected.At(x, y), 8);
  }
}

TEST(LocalContrastTest, HalfSizeIsTheMeanOfFour) {
  const GrayImage picture = RandomPicture(71, 53, 8);
  const GrayImage half = HalfSize(picture);
  ASSERT_EQ(half.width, 35);
  ASSERT_EQ(half.height, 26);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      const int sum = picture.At(2 * x, 2 * y) + picture.At(2 * x + 1, 2 * y) +
                      picture.At(2 * x, 2 * y + 1) + picture.At(2 * x + 1, 2 * y + 1);
      EXPECT_EQ(half.At(x, y), (sum + 2) / 4);
    }
  }
  EXPECT_TRUE(HalfSize(GrayImage(1, 40)).Empty());
}

TEST(LocalContrastTest, ExtremesFit) {
  for (const int level : {0, 255}) {
    const Image<int16_t> flat = LocalContrast(GrayImage(70, 70, 1, static_cast<uint8_t>(level)));
    for (const int16_t value : flat.data) EXPECT_EQ(value, 0);
  }
  GrayImage edge(200, 70, 1, 0);
  for (int y = 0; y < 70; ++y) std::fill(edge.Row(y) + 100, edge.Row(y) + 200, uint8_t{255});
  const Image<int16_t> contrast = LocalContrast(edge);
  EXPECT_NEAR(contrast.At(99 - 10, 35), -kContrastUnit * 255 * 20.0 / 61, 40);
  EXPECT_NEAR(contrast.At(100 + 10, 35), kContrastUnit * 255 * 20.0 / 61, 40);
  EXPECT_TRUE(LocalContrast(GrayImage()).Empty());
}

}  // namespace
}  // namespace colmap_seapoint
