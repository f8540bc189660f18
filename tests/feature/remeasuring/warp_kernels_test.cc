// The kernels against plain definitions, with every instruction set.
#include "feature/kernels/warp_kernels.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

GrayImage RandomPicture(int width, int height, unsigned seed) {
  GrayImage picture(width, height);
  std::mt19937 random(seed);
  for (uint8_t& value : picture.data) value = static_cast<uint8_t>(random() % 256);
  return picture;
}

double Keys(double distance) {
  const double d = std::abs(distance);
  if (d < 1) return 1 - 2.5 * d * d + 1.5 * d * d * d;
  return d < 2 ? 2 - 4 * d + 2.5 * d * d - 0.5 * d * d * d : 0;
}

double CubicAt(const GrayImage& picture, double x, double y) {
  double sum = 0;
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      sum += Keys(x - column) * Keys(y - row) * picture.At(column, row);
    }
  }
  return sum;
}

TEST(SampleWindow, IsKeysCubicConvolution) {
  const GrayImage picture = RandomPicture(61, 53, 1);
  const warp::Placement placements[] = {{30, 26, 1, 0, 0, 1},
                                        {29.37, 25.81, 0.9f, 0.2f, -0.3f, 0.8f},
                                        {30.5, 26.25, -1.1f, 0.1f, 0.2f, 1.2f},
                                        {30.999, 26.001, 0, 1, -1, 0}};
  for (const warp::Placement& p : placements) {
    for (const int reach : {warp::kReach, warp::kWideReach}) {
      ASSERT_TRUE(warp::IsInside(picture, p, reach));
      ForEachVectorTarget([&] {
        std::vector<float> out(warp::WindowSize(reach) + 1, -999.0f);
        warp::SampleWindow(picture, p, reach, out.data());
        EXPECT_EQ(out.back(), -999.0f);
        size_t at = 0;
        for (int j = -reach; j <= reach; ++j) {
          for (int i = -reach; i <= reach + 1; ++i, ++at) {
            const double x =
                p.x + i * static_cast<double>(p.x_across) + j * static_cast<double>(p.x_down);
            const double y =
                p.y + i * static_cast<double>(p.y_across) + j * static_cast<double>(p.y_down);
            EXPECT_NEAR(static_cast<double>(out[at]), CubicAt(picture, x, y), 0.01);
          }
        }
      });
    }
  }
}

// Far from the origin as near it.
TEST(SampleWindow, KeepsItsPrecisionInLargePictures) {
  const GrayImage small = RandomPicture(40, 40, 2);
  GrayImage large(20000, 40);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) large.At(19950 + x, y) = small.At(x, y);
  }
  warp::Patch near, far;
  warp::SampleWindow(small, {20.3, 19.6, 1, 0.1f, 0, 1}, warp::kReach, near.data());
  warp::SampleWindow(large, {19970.3, 19.6, 1, 0.1f, 0, 1}, warp::kReach, far.data());
  for (size_t i = 0; i < near.size(); ++i) EXPECT_NEAR(near[i], far[i], 0.01f);
}

TEST(IsInside, IsTheLeastPictureThatIsRead) {
  // Reads columns and rows from 1 before the first sample to 2 behind the last.
  const GrayImage picture(60, 50);
  const auto is_inside = [&](double x, double y) {
    return warp::IsInside(picture, {x, y, 1, 0, 0, 1}, warp::kReach);
  };
  EXPECT_TRUE(is_inside(10, 10));
  EXPECT_FALSE(is_inside(8.9, 20));
  EXPECT_FALSE(is_inside(20, 7.9));
  EXPECT_FALSE(is_inside(49.1, 20));
  EXPECT_FALSE(is_inside(20, 40.1));
  EXPECT_FALSE(is_inside(std::nan(""), 20));
}

TEST(SumShifts, AreThoseOfEachShift) {
  std::mt19937 random(3);
  warp::WholePatch patch = {};
  warp::WholeWindow window;
  constexpr int kWidth = 2 * warp::kReach + 1;
  for (int j = 0; j < kWidth; ++j) {
    for (int i = 0; i < kWidth; ++i) {
      patch[static_cast<size_t>(j * warp::Stride(warp::kReach) + i)] =
          static_cast<int16_t>(static_cast<int>(random() % 512) - 256);
    }
  }
  for (int16_t& value : window) value = static_cast<int16_t>(static_cast<int>(random() % 400) - 60);
  ForEachVectorTarget([&] {
    std::array<warp::ShiftSums, warp::kShifts * warp::kShifts> sums;
    warp::SumShifts(patch, window, &sums);
    for (int s = 0; s < warp::kShifts * warp::kShifts; ++s) {
      warp::ShiftSums expected;
      for (int j = 0; j < kWidth; ++j) {
        for (int i = 0; i < kWidth; ++i) {
          const int x = i + s % warp::kShifts, y = j + s / warp::kShifts;
          const int32_t other = window[static_cast<size_t>(y * warp::Stride(warp::kWideReach) + x)];
          expected.other += other;
          expected.other_other += other * other;
          expected.patch_other +=
              patch[static_cast<size_t>(j * warp::Stride(warp::kReach) + i)] * other;
        }
      }
      const warp::ShiftSums& sum = sums[static_cast<size_t>(s)];
      EXPECT_EQ(sum.other, expected.other);
      EXPECT_EQ(sum.other_other, expected.other_other);
      EXPECT_EQ(sum.patch_other, expected.patch_other);
    }
  });
}

TEST(Dot, IsTheSameOnEveryVectorUnit) {
  std::mt19937 random(4);
  std::normal_distribution<float> normal(0, 50);
  warp::Patch a, b;
  for (float& value : a) value = normal(random);
  for (float& value : b) value = normal(random);
  double expected = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    expected += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  }
  std::vector<double> dots;
  ForEachVectorTarget([&] { dots.push_back(warp::Dot(a, b)); });
  for (const double dot : dots) EXPECT_EQ(dot, dots[0]);
  EXPECT_NEAR(dots[0], expected, 1.0);
}

}  // namespace
}  // namespace colmap_seapoint
