#include "densify/zncc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/densify/portable_zncc.h"

namespace colmap_seapoint {
namespace {

GrayImage RandomPicture(int width, int height, unsigned seed, int low = 0, int high = 255) {
  std::mt19937 generator(seed);
  GrayImage picture(width, height);
  const auto range = static_cast<unsigned>(high - low + 1);
  for (uint8_t& value : picture.data)
    value = static_cast<uint8_t>(low + static_cast<int>(generator() % range));
  return picture;
}

// The textbook: means first, then deviations. -1 where the second window's variance is below 1.
double TextbookZncc(const GrayImage& a, int x1, int y1, const GrayImage& b, int x2, int y2,
                    int size) {
  const int half = size / 2, count = size * size;
  double mean1 = 0, mean2 = 0;
  for (int v = -half; v <= half; ++v) {
    for (int u = -half; u <= half; ++u) {
      mean1 += a.At(x1 + u, y1 + v);
      mean2 += b.At(x2 + u, y2 + v);
    }
  }
  mean1 /= count;
  mean2 /= count;
  double s11 = 0, s12 = 0, s22 = 0;
  for (int v = -half; v <= half; ++v) {
    for (int u = -half; u <= half; ++u) {
      const double d1 = a.At(x1 + u, y1 + v) - mean1, d2 = b.At(x2 + u, y2 + v) - mean2;
      s11 += d1 * d1;
      s12 += d1 * d2;
      s22 += d2 * d2;
    }
  }
  return s22 / count < 1 ? -1 : s12 / std::sqrt(s11 * s22);
}

// Exact integers and one rounding: equal to the bit with and without vectors.
float IntegerZncc(const GrayImage& a, int x1, int y1, const GrayImage& b, int x2, int y2,
                  int size) {
  const int half = size / 2;
  int64_t n = static_cast<int64_t>(size) * size, s1 = 0, s2 = 0, s11 = 0, s12 = 0, s22 = 0;
  for (int v = -half; v <= half; ++v) {
    for (int u = -half; u <= half; ++u) {
      const int64_t p = a.At(x1 + u, y1 + v), q = b.At(x2 + u, y2 + v);
      s1 += p;
      s2 += q;
      s11 += p * p;
      s12 += p * q;
      s22 += q * q;
    }
  }
  const auto scatter1 = static_cast<double>(n * s11 - s1 * s1);
  const auto scatter2 = static_cast<double>(n * s22 - s2 * s2);
  if (scatter2 < static_cast<double>(n * n)) return -1;
  return static_cast<float>(static_cast<double>(n * s12 - s1 * s2) /
                            std::sqrt(scatter1 * scatter2));
}

TEST(ZnccTest, EqualsTheTextbook) {
  const GrayImage dark = RandomPicture(64, 40, 1, 20, 26),
                  bright = RandomPicture(64, 40, 2, 0, 255);
  GrayImage mixed = bright;
  for (size_t i = 0; i < mixed.data.size(); ++i) {
    mixed.data[i] = static_cast<uint8_t>((mixed.data[i] + 3 * dark.data[i]) / 4);
  }
  for (const int size : {5, 7, 9, 11, 13, 15}) {
    for (const auto& [a, b] : {std::pair<const GrayImage*, const GrayImage*>{&bright, &mixed},
                               {&dark, &mixed},
                               {&dark, &dark},
                               {&bright, &bright}}) {
      for (int trial = 0; trial < 40; ++trial) {
        const int x1 = 7 + trial, y1 = 7 + trial % 25, x2 = 7 + trial * 7 % 40,
                  y2 = 7 + trial * 5 % 25;
        const ZnccReference reference(*a, x1, y1, size);
        ASSERT_TRUE(reference.HasTexture());
        const float score = reference.Score(*b, x2, y2);
        ASSERT_NEAR(score, TextbookZncc(*a, x1, y1, *b, x2, y2, size), 1e-6);
        ASSERT_EQ(score, IntegerZncc(*a, x1, y1, *b, x2, y2, size));
        ASSERT_EQ(score, PortableZncc(*a, x1, y1, *b, x2, y2, size));
      }
    }
  }
}

// Black and white: the largest sums there are.
TEST(ZnccTest, ExtremesDoNotOverflow) {
  GrayImage a(48, 16), b(48, 16);
  for (size_t i = 0; i < a.data.size(); ++i) {
    a.data[i] = i % 2 ? 255 : 0;
    b.data[i] = i % 2 ? 0 : 255;
  }
  const ZnccReference reference(a, 8, 8, 15);
  EXPECT_EQ(reference.Score(a, 8, 8), 1);
  EXPECT_EQ(reference.Score(b, 8, 8), -1);
  EXPECT_EQ(PortableZncc(a, 8, 8, a, 8, 8, 15), 1);
  GrayImage white(48, 16, 1, 255);
  white.At(9, 9) = 0;
  EXPECT_EQ(ZnccReference(white, 8, 8, 15).Score(white, 8, 8), 1);
}

TEST(ZnccTest, BlindToGainAndOffset) {
  const GrayImage a = RandomPicture(40, 30, 3, 0, 60);
  GrayImage b = a;
  for (uint8_t& value : b.data) value = static_cast<uint8_t>(4 * value + 13);
  EXPECT_FLOAT_EQ(ZnccReference(a, 15, 15, 9).Score(b, 15, 15), 1);
  for (uint8_t& value : b.data) value = static_cast<uint8_t>(255 - value);
  EXPECT_FLOAT_EQ(ZnccReference(a, 15, 15, 9).Score(b, 15, 15), -1);
}

TEST(ZnccTest, NoTexture) {
  const GrayImage texture = RandomPicture(40, 30, 4), flat(40, 30, 1, 200);
  EXPECT_FALSE(ZnccReference(flat, 15, 15, 9).HasTexture());
  EXPECT_EQ(ZnccReference(texture, 15, 15, 9).Score(flat, 15, 15), -1);
  // Variance just below and just above 1.
  GrayImage faint(40, 30, 1, 100);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) faint.At(x, y) = static_cast<uint8_t>(100 + (x + y) % 2);
  }
  EXPECT_FALSE(ZnccReference(faint, 15, 15, 9).HasTexture());
  for (uint8_t& value : faint.data) value = static_cast<uint8_t>(100 + 3 * (value - 100));
  EXPECT_TRUE(ZnccReference(faint, 15, 15, 9).HasTexture());
}

// The bytes beside the window do not count, though they are read.
TEST(ZnccTest, OnlyTheWindowCounts) {
  const GrayImage a = RandomPicture(40, 30, 5);
  for (const int size : {5, 7, 9, 11, 13, 15}) {
    GrayImage b = a;
    const int half = size / 2;
    for (int y = 0; y < 30; ++y) {
      for (int x = 0; x < 40; ++x) {
        if (std::abs(x - 15) > half || std::abs(y - 15) > half) b.At(x, y) = 255;
      }
    }
    EXPECT_EQ(ZnccReference(a, 15, 15, size).Score(b, 15, 15), 1);
    EXPECT_EQ(ZnccReference(b, 15, 15, size).Score(a, 15, 15), 1);
  }
}

}  // namespace
}  // namespace colmap_seapoint
