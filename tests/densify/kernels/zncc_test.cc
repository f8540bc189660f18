#include "densify/kernels/zncc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

using zncc::kMaxRun;

constexpr size_t kSlack = 16;  // bytes behind a picture

GrayImage RandomPicture(int width, int height, unsigned seed, int low = 1, int high = 255) {
  std::mt19937 generator(seed);
  GrayImage picture(width, height);
  const auto range = static_cast<unsigned>(high - low + 1);
  for (uint8_t& value : picture.data) {
    value = static_cast<uint8_t>(low + static_cast<int>(generator() % range));
  }
  picture.data.resize(picture.data.size() + kSlack);
  return picture;
}

float ScoreOne(const GrayImage& a, int x1, int y1, const GrayImage& b, int x2, int y2, int size) {
  float score = 0;
  zncc::ScoreRun(a, x1, y1, b, x2, y2, size, 1, &score);
  return score;
}

// The textbook: means first, then deviations.
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
  if (s11 / count < 1 || s22 / count < 1) return -1;
  for (const int v : {-half, half}) {
    for (const int u : {-half, half}) {
      if (b.At(x2 + u, y2 + v) == 0) return -1;
    }
  }
  return s12 / std::sqrt(s11 * s22);
}

// Exact integers, then three rounded operations: equal to the bit, whatever the vectors.
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
  const float scatter1 = static_cast<float>(n * s11 - s1 * s1);
  const float scatter2 = static_cast<float>(n * s22 - s2 * s2);
  return static_cast<float>(n * s12 - s1 * s2) / std::sqrt(scatter1 * scatter2);
}

TEST(ZnccTest, EqualsTheTextbook) {
  const GrayImage dark = RandomPicture(64, 40, 1, 20, 26), bright = RandomPicture(64, 40, 2);
  GrayImage mixed = bright, holes = bright;
  for (size_t i = 0; i < mixed.data.size(); ++i) {
    mixed.data[i] = static_cast<uint8_t>((mixed.data[i] + 3 * dark.data[i]) / 4);
  }
  std::mt19937 generator(5);
  for (uint8_t& value : holes.data) value = generator() % 9 == 0 ? 0 : value;
  const std::vector<std::pair<const GrayImage*, const GrayImage*>> pairs = {
      {&bright, &mixed}, {&dark, &mixed}, {&dark, &dark}, {&bright, &bright}, {&holes, &holes}};
  int num_outside = 0;
  ForEachVectorTarget([&] {
    for (const int size : {5, 7, 9, 11, 13, 15}) {
      for (const auto& [a, b] : pairs) {
        for (int trial = 0; trial < 40; ++trial) {
          const int x1 = 7 + trial, y1 = 7 + trial % 25;
          const int x2 = 7 + trial * 7 % 40, y2 = 7 + trial * 5 % 25;
          float scores[kMaxRun + 1];
          const int count = 1 + trial % kMaxRun;
          scores[count] = 7;
          zncc::ScoreRun(*a, x1, y1, *b, x2, y2, size, count, scores);
          ASSERT_EQ(scores[count], 7);  // nothing beyond the run is written
          for (int k = 0; k < count; ++k) {
            const double textbook = TextbookZncc(*a, x1, y1, *b, x2 + k, y2, size);
            ASSERT_NEAR(scores[k], textbook, 1e-6);
            num_outside += textbook == -1;
            const float exact = textbook == -1 ? -1 : IntegerZncc(*a, x1, y1, *b, x2 + k, y2, size);
            ASSERT_EQ(scores[k], exact);
          }
        }
      }
    }
  });
  EXPECT_GT(num_outside, 100);
}

// Black and white: the largest sums there are.
TEST(ZnccTest, ExtremesDoNotOverflow) {
  GrayImage a = RandomPicture(48, 16, 1), b = a, white = RandomPicture(48, 16, 1, 255), black = a;
  for (size_t i = 0; i < a.data.size(); ++i) {
    a.data[i] = i % 2 ? 255 : 1;
    b.data[i] = i % 2 ? 1 : 255;
    black.data[i] = i % 5 == 1 ? 1 : 0;
  }
  white.At(9, 9) = 0;
  for (const auto& [x, y] : {std::pair{8, 8}, {1, 1}, {1, 15}, {15, 1}, {15, 15}}) {
    black.At(x, y) = 2;  // corners that are there
  }
  ForEachVectorTarget([&] {
    EXPECT_EQ(ScoreOne(a, 8, 8, a, 8, 8, 15), 1);
    EXPECT_EQ(ScoreOne(a, 8, 8, b, 8, 8, 15), -1);
    EXPECT_EQ(ScoreOne(white, 8, 8, white, 8, 8, 15), 1);
    EXPECT_NEAR(ScoreOne(white, 8, 8, black, 8, 8, 15), TextbookZncc(white, 8, 8, black, 8, 8, 15),
                1e-6);
  });
}

TEST(ZnccTest, BlindToGainAndOffset) {
  const GrayImage a = RandomPicture(40, 30, 3, 0, 60);
  GrayImage b = a;
  for (uint8_t& value : b.data) value = static_cast<uint8_t>(4 * value + 13);
  EXPECT_FLOAT_EQ(ScoreOne(a, 15, 15, b, 15, 15, 9), 1);
  for (uint8_t& value : b.data) value = static_cast<uint8_t>(255 - value + 1);
  EXPECT_FLOAT_EQ(ScoreOne(a, 15, 15, b, 15, 15, 9), -1);
}

TEST(ZnccTest, NoTexture) {
  const GrayImage texture = RandomPicture(40, 30, 4), flat = RandomPicture(40, 30, 4, 200, 200);
  ForEachVectorTarget([&] {
    EXPECT_EQ(ScoreOne(flat, 15, 15, texture, 15, 15, 9), -1);
    EXPECT_EQ(ScoreOne(texture, 15, 15, flat, 15, 15, 9), -1);
  });
  // Variance just below and just above 1.
  GrayImage faint = flat;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) faint.At(x, y) = static_cast<uint8_t>(100 + (x + y) % 2);
  }
  EXPECT_EQ(ScoreOne(faint, 15, 15, faint, 15, 15, 9), -1);
  for (uint8_t& value : faint.data) value = static_cast<uint8_t>(100 + 3 * (value - 100));
  EXPECT_EQ(ScoreOne(faint, 15, 15, faint, 15, 15, 9), 1);
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
    ForEachVectorTarget([&] {
      EXPECT_EQ(ScoreOne(a, 15, 15, b, 15, 15, size), 1);
      EXPECT_EQ(ScoreOne(b, 15, 15, a, 15, 15, size), 1);
    });
  }
}

}  // namespace
}  // namespace colmap_seapoint
