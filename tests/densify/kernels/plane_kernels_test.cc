#include "densify/kernels/plane_kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "densify/match/surface_fit.h"
#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

struct Fit {
  double value = 0, slope_x = 0, slope_y = 0;  // slopes a sample
  double scatter = 0;
  int support = 0;
};

// Least squares in double precision, from the normal equations of d = value + p u + q v.
Fit LeastSquares(const std::vector<float>& map, int width, int height, int a, int b, int radius,
                 float tolerance) {
  const auto at = [&](int x, int y) {
    return map[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  };
  Fit fit;
  const float center = at(a, b);
  double squares = 0;
  if (!(center > 0)) return fit;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int y = std::max(0, b - radius); y <= std::min(height - 1, b + radius); ++y) {
    for (int x = std::max(0, a - radius); x <= std::min(width - 1, a + radius); ++x) {
      if (!(at(x, y) > 0) || std::abs(at(x, y) - center) > tolerance) continue;
      const Eigen::Vector3d row(1, x - a, y - b);
      normal += row * row.transpose();
      right += row * static_cast<double>(at(x, y));
      squares += std::pow(static_cast<double>(at(x, y)), 2);
      fit.scatter += std::pow(static_cast<double>(at(x, y) - center), 2);
      ++fit.support;
    }
  }
  fit.value = center;
  fit.scatter = std::sqrt(fit.scatter / fit.support);
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(normal);
  if (fit.support < 6 || !lu.isInvertible()) return fit;
  const Eigen::Vector3d plane = lu.solve(right);
  fit.value = plane[0];
  fit.slope_x = plane[1];
  fit.slope_y = plane[2];
  fit.scatter = std::sqrt(std::max(0.0, squares - plane.dot(right)) / fit.support);
  return fit;
}

// Planes on either side of a diagonal depth edge, noise, holes, lone samples.
std::vector<float> RandomMap(int width, int height, std::mt19937* generator) {
  std::uniform_real_distribution<float> unit(-1, 1);
  const float p = unit(*generator), q = unit(*generator);
  const unsigned holes = (*generator)() % 4;  // of 5
  std::vector<float> map;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float level = 3 * x + 2 * y > 40 ? 60.0f : 75.0f;
      const float d = level + 0.5f * (p * static_cast<float>(x) + q * static_cast<float>(y)) +
                      0.3f * unit(*generator);
      map.push_back((*generator)() % 5 < holes ? -1.0f * static_cast<float>((*generator)() % 2)
                                               : d);
    }
  }
  return map;
}

TEST(PlaneKernelsTest, EqualsLeastSquares) {
  std::mt19937 generator(3);
  int num_fitted = 0, num_own = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const int width = 1 + static_cast<int>(generator() % 45);
    const int height = 1 + static_cast<int>(generator() % 20), radius = 1 + trial % 4;
    const std::vector<float> map = RandomMap(width, height, &generator);
    const float tolerance = 1.2f * static_cast<float>(radius);
    // All rows, or some of them.
    const int begin = trial % 3 == 0 ? 0 : static_cast<int>(generator()) & 1;
    const int end = trial % 3 == 0 ? height : height - (height > 3);
    const float scale = trial % 2 ? 0.25f : 1;
    ForEachVectorTarget([&] {
      std::vector<float> value(map.size(), -7), slope_x = value, slope_y = value, scatter = value;
      std::vector<uint8_t> support(map.size(), 200);
      plane::FitRows(
          {map.data(), width, height}, begin, end, radius, tolerance, scale,
          {value.data(), slope_x.data(), slope_y.data(), scatter.data(), support.data()});
      for (int b = 0; b < height; ++b) {
        for (int a = 0; a < width; ++a) {
          const size_t i =
              static_cast<size_t>(b) * static_cast<size_t>(width) + static_cast<size_t>(a);
          if (b < begin || b >= end) {
            ASSERT_EQ(value[i], -7);  // not asked for
            ASSERT_EQ(support[i], 200);
            continue;
          }
          const Fit fit = LeastSquares(map, width, height, a, b, radius, tolerance);
          ASSERT_EQ(support[i], fit.support) << a << " " << b;
          ASSERT_NEAR(value[i], fit.value, 5e-5) << a << " " << b;
          ASSERT_NEAR(scatter[i], fit.scatter, 2e-3) << a << " " << b;
          ASSERT_NEAR(slope_x[i], scale * fit.slope_x, 5e-5) << a << " " << b;
          ASSERT_NEAR(slope_y[i], scale * fit.slope_y, 5e-5) << a << " " << b;
          if (fit.support < 6 && fit.support > 0) {
            ASSERT_EQ(value[i], map[i]);
          }
          ++(fit.slope_x != 0 ? num_fitted : num_own);
        }
      }
    });
  }
  EXPECT_GT(num_fitted, 50000);
  EXPECT_GT(num_own, 5000);
}

PartialDisparity RandomPartial(int step) {
  std::mt19937 generator(4);
  PartialDisparity partial;
  partial.grid = SampleGrid({3, -5, 130 * step, 70 * step}, step);
  partial.disparity = RandomMap(partial.grid.width, partial.grid.height, &generator);
  partial.score.assign(partial.grid.Size(), 0.9f);
  return partial;
}

TEST(SurfaceFitTest, SameWithAnyThreadsAndVectors) {
  const PartialDisparity partial = RandomPartial(2);
  const PartialSurface surface = FitSurface(partial, 3, 0.7f, 1);
  for (const int num_threads : {1, 2, 5}) {
    ForEachVectorTarget([&] {
      const PartialSurface other = FitSurface(partial, 3, 0.7f, num_threads);
      EXPECT_EQ(other.disparity, surface.disparity);
      EXPECT_EQ(other.slope_x, surface.slope_x);
      EXPECT_EQ(other.slope_y, surface.slope_y);
      EXPECT_EQ(other.support, surface.support);
      EXPECT_EQ(other.deviation, surface.deviation);
    });
  }
}

// Samples with a deviation of 0.1 on a plane, a hole in its middle; then with scatter, too.
TEST(SurfaceFitTest, TheDeviationGrowsWithScatterAndLackOfSupport) {
  PartialDisparity partial = RandomPartial(1);
  std::mt19937 generator(5);
  for (const float scatter : {0.0f, 0.3f}) {
    std::normal_distribution<float> noise(0, scatter);
    for (float& d : partial.disparity) d = 50 + (scatter > 0 ? noise(generator) : 0);
    const auto width = static_cast<size_t>(partial.grid.width);
    const size_t hole = 30 * width + 60;
    partial.disparity[hole] = 0;
    partial.deviation.assign(partial.grid.Size(), 0.1f);
    const PartialSurface surface = FitSurface(partial, 2, 0.75f, 2);
    const float all_agree = std::hypot(0.1f, scatter);
    EXPECT_EQ(surface.deviation[hole], 0);
    if (scatter == 0) {
      EXPECT_FLOAT_EQ(surface.deviation[40 * width + 60], all_agree);
      EXPECT_FLOAT_EQ(surface.deviation[hole + 1], all_agree * 25 / 24);
      EXPECT_FLOAT_EQ(surface.deviation[0], all_agree * 25 / 9);
      continue;
    }
    double sum = 0;
    for (size_t a = 10; a < 120; ++a) sum += static_cast<double>(surface.deviation[50 * width + a]);
    EXPECT_NEAR(sum / 110, all_agree, 0.15 * all_agree);  // less the three freedoms of a plane
  }
}

// Samples `step` pixels apart: max_slope and the slopes are a pixel, not a sample.
TEST(SurfaceFitTest, SlopesAreAPixel) {
  for (const int step : {1, 2, 4}) {
    for (int radius = 2; radius <= 4; ++radius) {
      PartialDisparity partial = RandomPartial(step);
      for (int b = 0; b < partial.grid.height; ++b) {
        for (int a = 0; a < partial.grid.width; ++a) {
          const double d = 300 + 0.25 * partial.grid.PixelX(a) - 0.3 * partial.grid.PixelY(b);
          partial.disparity[static_cast<size_t>(b * partial.grid.width + a)] =
              static_cast<float>(a < 60 ? d : d - 40);
        }
      }
      const PartialSurface surface = FitSurface(partial, radius, 0.6f, 2);
      for (size_t i = 0; i < surface.grid.Size(); ++i) {
        ASSERT_NEAR(surface.slope_x[i], 0.25, 1e-4);
        ASSERT_NEAR(surface.slope_y[i], -0.3, 1e-4);
        ASSERT_NEAR(surface.disparity[i], partial.disparity[i], 1e-3);
      }
    }
  }
}

// Disparities that depend on the column only, with noise.
PartialDisparity Profile(double noise, const std::function<double(int x)>& profile) {
  std::mt19937 generator(6);
  std::normal_distribution<double> off(0, noise);
  PartialDisparity partial = RandomPartial(1);
  for (size_t i = 0; i < partial.disparity.size(); ++i) {
    const int x = static_cast<int>(i % static_cast<size_t>(partial.grid.width));
    partial.disparity[i] = static_cast<float>(profile(x) + off(generator));
  }
  partial.deviation.assign(partial.grid.Size(), static_cast<float>(noise));
  return partial;
}

// Noise alone does not make a plane rough.
TEST(RoughSurfaceTest, APlaneIsFittedAsOne) {
  for (const double noise : {0.02, 0.1, 0.3}) {
    for (int radius = 2; radius <= 4; ++radius) {
      const PartialDisparity partial = Profile(noise, [](int x) { return 300 + 0.25 * x; });
      const PartialSurface plane = FitSurface(partial, radius, 0.75f, 2);
      const PartialSurface rough = FitRoughSurface(partial, radius, 0.75f, 2);
      int num_other = 0;
      for (size_t i = 0; i < plane.grid.Size(); ++i) {
        num_other += rough.disparity[i] != plane.disparity[i] ||
                     rough.slope_x[i] != plane.slope_x[i] || rough.slope_y[i] != plane.slope_y[i];
      }
      EXPECT_LT(num_other, 0.01 * static_cast<double>(plane.grid.Size())) << noise << " " << radius;
    }
  }
}

// The large plane cuts a ridge off, by up to 0.8 pixels here, the small one by less. What lies far
// from it is not rough, and how sure it is remains what the large plane says.
TEST(RoughSurfaceTest, ARidgeKeepsMoreOfItsHeight) {
  constexpr int kRidge = 65;
  for (const double slope : {0.3, 0.5}) {
    const auto truth = [slope](int x) { return 300 - slope * std::abs(x - kRidge); };
    const PartialDisparity partial = Profile(0.03, truth);
    for (int radius = 2; radius <= 4; ++radius) {
      const PartialSurface plane = FitSurface(partial, radius, 0.75f, 2);
      const PartialSurface rough = FitRoughSurface(partial, radius, 0.75f, 2);
      double of_plane = 0, of_rough = 0;
      for (size_t i = 0; i < plane.grid.Size(); ++i) {
        const int x = static_cast<int>(i % static_cast<size_t>(plane.grid.width));
        if (std::abs(x - kRidge) > radius) {
          ASSERT_EQ(rough.disparity[i], plane.disparity[i]) << x;
        } else if (std::abs(x - kRidge) <= 1) {
          of_plane += std::pow(static_cast<double>(plane.disparity[i]) - truth(x), 2);
          of_rough += std::pow(static_cast<double>(rough.disparity[i]) - truth(x), 2);
        }
      }
      // By a tenth at least; half of radius 2 leaves little to fit to.
      EXPECT_LT(std::sqrt(of_rough / of_plane), radius == 2 ? 0.95 : 0.9) << slope << " " << radius;
      EXPECT_EQ(rough.deviation, plane.deviation);
      EXPECT_EQ(rough.support, plane.support);
      const PartialSurface one_thread = FitRoughSurface(partial, radius, 0.75f, 1);
      EXPECT_EQ(rough.disparity, one_thread.disparity);
      EXPECT_EQ(rough.slope_x, one_thread.slope_x);
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
