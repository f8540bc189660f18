#include "colmap_seapoint/base/picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

ColorImage RandomColors(int width, int height) {
  ColorImage color(width, height, 3);
  std::mt19937 random(5);
  for (uint8_t& value : color.data) value = static_cast<uint8_t>(random());
  for (size_t i = 0; i < 24; ++i) color.data[i] = i / 3 & 1u << i % 3 ? 255 : 0;  // the corners
  return color;
}

TEST(Picture, LumaIsOpenCvsGrey) {
  ColorImage color = RandomColors(317, 211);
  cv::Mat oracle;
  cv::cvtColor(cv::Mat(color.height, color.width, CV_8UC3, color.data.data()), oracle,
               cv::COLOR_RGB2GRAY);
  ForEachVectorTarget([&] {
    const GrayImage luma = LumaOf(color);
    for (int y = 0; y < luma.height; ++y) {
      for (int x = 0; x < luma.width; ++x) ASSERT_EQ(luma.At(x, y), oracle.at<uint8_t>(y, x));
    }
  });
}

// JFIF's own numbers, to 2^-16. (A half is rounded down: 255.5 must not become 256.)
TEST(Picture, ChromaIsJfifsWithEveryInstructionSet) {
  for (const int width : {1, 3, 15, 16, 17, 33, 317}) {
    const ColorImage color = RandomColors(width, 8);
    ForEachVectorTarget([&] {
      const Picture picture = PictureOf(color);
      for (size_t i = 0; i < picture.cb.data.size(); ++i) {
        const int64_t r = color.data[3 * i], g = color.data[3 * i + 1], b = color.data[3 * i + 2];
        const int64_t cb = -11058 * r - 21710 * g + 32768 * b + (128 << 16);
        const int64_t cr = 32768 * r - 27439 * g - 5329 * b + (128 << 16);
        ASSERT_EQ(picture.cb.data[i], (cb + 32767) / 65536);
        ASSERT_EQ(picture.cr.data[i], (cr + 32767) / 65536);
        ASSERT_NEAR(picture.cb.data[i], 128 - 0.168735892 * r - 0.331264108 * g + 0.5 * b, 0.51);
        ASSERT_NEAR(picture.cr.data[i], 128 + 0.5 * r - 0.418687589 * g - 0.081312411 * b, 0.51);
      }
    });
  }
}

TEST(Picture, ColorsComeBackWithinTwoLevels) {
  const ColorImage color = RandomColors(317, 211);
  const Picture picture = PictureOf(color);
  EXPECT_EQ(picture.luma.data, LumaOf(color).data);
  EXPECT_EQ(picture.NumBytes(), color.data.size());
  const ColorImage back = ColorOf(picture);
  ASSERT_EQ(back.data.size(), color.data.size());
  double sum = 0;
  for (size_t i = 0; i < color.data.size(); ++i) {
    ASSERT_LE(std::abs(back.data[i] - color.data[i]), 2) << i;
    sum += back.data[i] - color.data[i];
  }
  EXPECT_NEAR(sum / static_cast<double>(color.data.size()), 0, 0.05);
}

TEST(Picture, GreyHasNoColor) {
  Picture picture;
  picture.luma = GrayImage(3, 2, 1, 77);
  EXPECT_FALSE(picture.HasColor());
  EXPECT_EQ(ColorOf(picture).data, ColorImage(3, 2, 3, 77).data);
  ColorImage gray(256, 1, 3);
  for (size_t i = 0; i < gray.data.size(); ++i) gray.data[i] = static_cast<uint8_t>(i / 3);
  const Picture planes = PictureOf(gray);
  EXPECT_EQ(planes.cb.data, GrayImage(256, 1, 1, 128).data);
  EXPECT_EQ(planes.cr.data, GrayImage(256, 1, 1, 128).data);
  EXPECT_EQ(ColorOf(planes).data, gray.data);
}

// Chroma that grows linearly is interpolated exactly between the samples' centres, and constant
// beyond the outermost ones.
TEST(Picture, ChromaLiesAtTheMiddleOfItsPixels) {
  for (int shift_x = 0; shift_x <= 2; ++shift_x) {
    for (int shift_y = 0; shift_y <= 2; ++shift_y) {
      constexpr int kWidth = 21, kHeight = 18;
      const int step_x = 1 << shift_x, step_y = 1 << shift_y;
      const int width = (kWidth + step_x - 1) / step_x, height = (kHeight + step_y - 1) / step_y;
      Picture picture;
      picture.chroma_shift_x = shift_x;
      picture.chroma_shift_y = shift_y;
      picture.luma = GrayImage(kWidth, kHeight, 1, 128);
      picture.cb = GrayImage(width, height, 1, 128);
      picture.cr = GrayImage(width, height);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          picture.cr.At(x, y) = static_cast<uint8_t>(100 + step_x * x + 2 * step_y * y);
        }
      }
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const double at_x = std::clamp((x + 0.5) / step_x - 0.5, 0.0, width - 1.0);
          const double at_y = std::clamp((y + 0.5) / step_y - 0.5, 0.0, height - 1.0);
          const double cr = 100 + step_x * at_x + 2 * step_y * at_y - 128;
          ASSERT_NEAR(ColorAt(picture, x, y)[0], 128 + 1.402 * cr, 1.21) << x << " " << y;
          ASSERT_NEAR(ColorAt(picture, x, y)[1], 128 - 0.714136 * cr, 0.87) << x << " " << y;
          ASSERT_EQ(ColorAt(picture, x, y)[2], 128);
        }
      }
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
