#include "densify/kernels/rectify_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "densify/match/rectification.h"
#include "tests/synthetic/world.h"
#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(RectifyKernelsTest, InterpolatesBetweenNodes) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> position(-300, 3000);
  for (int width = 1; width <= 70; ++width) {
    const size_t num_nodes = static_cast<size_t>(width / rectify::kCell + 2);
    std::vector<float> above, below;
    for (size_t k = 0; k < 2 * num_nodes; ++k) {
      above.push_back(generator() % 12 == 0 ? kNan : position(generator));
      below.push_back(generator() % 12 == 0 ? kNan : position(generator));
    }
    for (const float v : {0.0f, 0.125f, 0.875f}) {
      ForEachVectorTarget([&] {
        // As long as promised, so that a sanitizer or valgrind sees what is written beyond.
        std::vector<float> x(static_cast<size_t>(width) + rectify::kSlack), y(x.size());
        rectify::InterpolateRow(above.data(), below.data(), v, width, x.data(), y.data());
        for (size_t i = 0; i < static_cast<size_t>(width); ++i) {
          for (const size_t k : {size_t{0}, size_t{1}}) {
            const size_t node = i / rectify::kCell * 2 + k;
            const double u = static_cast<double>(i % rectify::kCell) / rectify::kCell;
            const double expected = (1 - v) * ((1 - u) * above[node] + u * above[node + 2]) +
                                    v * ((1 - u) * below[node] + u * below[node + 2]);
            const float actual = k == 0 ? x[i] : y[i];
            if (std::isnan(expected)) {
              ASSERT_TRUE(std::isnan(actual));
            } else {
              ASSERT_NEAR(actual, expected, 2e-3);
            }
          }
        }
      });
    }
  }
}

// The definition: bilinear with weights cut to 256ths, rounded once.
int Bilinear(const GrayImage& source, float x, float y) {
  if (!(x >= 0.5f && y >= 0.5f && x < static_cast<float>(source.width) - 0.5f &&
        y < static_cast<float>(source.height) - 0.5f)) {
    return 0;
  }
  const int x0 = static_cast<int>(x - 0.5f), y0 = static_cast<int>(y - 0.5f);
  const int u = static_cast<int>(256 * (x - 0.5f - static_cast<float>(x0)));
  const int v = static_cast<int>(256 * (y - 0.5f - static_cast<float>(y0)));
  const int above = (256 - u) * source.At(x0, y0) + u * source.At(x0 + 1, y0);
  const int below = (256 - u) * source.At(x0, y0 + 1) + u * source.At(x0 + 1, y0 + 1);
  return std::max(1, ((256 - v) * above + v * below + (1 << 15)) >> 16);
}

// Source pictures end where their last pixel does: what reads beyond, a sanitizer or valgrind sees.
TEST(RectifyKernelsTest, SamplesBilinearlyUpToTheRims) {
  std::mt19937 generator(2);
  const int sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {2, 2}, {2, 1}, {3, 2}, {2, 3}, {5, 4}, {37, 23}};
  int num_inside = 0, num_outside = 0;
  for (const auto& size : sizes) {
    GrayImage source(size[0], size[1]);
    for (uint8_t& value : source.data) value = static_cast<uint8_t>(generator());
    source.data.shrink_to_fit();
    const float right = static_cast<float>(source.width),
                bottom = static_cast<float>(source.height);
    std::uniform_real_distribution<float> any_x(-2, right + 2), any_y(-2, bottom + 2);
    // The first and the last positions of all, on pixel centres, and nonsense.
    const std::vector<float> xs = {0.5f,
                                   std::nextafter(0.5f, 0.0f),
                                   right - 0.5f,
                                   right - 1.5f,
                                   std::nextafter(right - 0.5f, 0.0f),
                                   kNan,
                                   1e30f,
                                   -1e30f};
    const std::vector<float> ys = {0.5f,
                                   std::nextafter(0.5f, 0.0f),
                                   bottom - 0.5f,
                                   bottom - 1.5f,
                                   std::nextafter(bottom - 0.5f, 0.0f),
                                   kNan,
                                   1e30f,
                                   -1e30f};
    for (int width = 1; width <= 70; ++width) {
      std::vector<float> x, y;
      for (size_t i = 0; i < static_cast<size_t>(width) + rectify::kSlack; ++i) {
        x.push_back(generator() % 2 ? any_x(generator) : xs[generator() % xs.size()]);
        y.push_back(generator() % 2 ? any_y(generator) : ys[generator() % ys.size()]);
      }
      ForEachVectorTarget([&] {
        std::vector<uint8_t> gray(static_cast<size_t>(width) + 1, 77);
        rectify::SampleRow(source, x.data(), y.data(), width, gray.data());
        for (size_t i = 0; i < static_cast<size_t>(width); ++i) {
          ASSERT_EQ(gray[i], Bilinear(source, x[i], y[i])) << x[i] << " " << y[i];
          ++(gray[i] > 0 ? num_inside : num_outside);
        }
        ASSERT_EQ(gray.back(), 77);  // nothing behind the row is written
      });
    }
  }
  EXPECT_GT(num_inside, 5000);
  EXPECT_GT(num_outside, 5000);
}

// A whole picture through a lens, turned: against the map's own positions and plain arithmetic.
TEST(RectifyKernelsTest, RectifyIsBilinearAtTheMapsPositions) {
  const Viewpoint view1 =
      StandAt(MildCamera(CameraModel::kFullOpenCV, 150, 131, 97), {0, 0, 0}, {8, -12, 25});
  const Viewpoint view2 =
      StandAt(MildCamera(CameraModel::kFullOpenCV, 150, 131, 97), {0.4, 0.1, 0.1}, {-5, 10, 12});
  const auto geometry =
      MakePairGeometry(view1.camera, view1.cam_from_world, view2.camera, view2.cam_from_world);
  ASSERT_TRUE(geometry);
  GrayImage source(131, 97);
  std::mt19937 generator(3);
  for (uint8_t& value : source.data) value = static_cast<uint8_t>(generator());
  const RectWindow window = WindowOfPicture(*geometry, false);
  const RectMap map(*geometry, false, window, 2);
  BlockMask all(window);
  all.Want(0, 0, window.width, window.height);
  const RectPicture picture = map.Rectify(source, all, 1);
  ForEachVectorTarget([&] {
    for (const int num_threads : {1, 3}) {
      EXPECT_EQ(map.Rectify(source, all, num_threads).gray.data, picture.gray.data);
    }
  });
  int num_inside = 0, num_wrong_rim = 0;
  for (int j = 0; j < window.height; ++j) {
    for (int i = 0; i < window.width; ++i) {
      const auto at = map.Source(i, j);
      const int value = picture.gray.At(i, j);
      if (!at) {
        num_wrong_rim += value != 0;  // within rounding of the rim
        continue;
      }
      const double x = static_cast<double>(at->x()) - 0.5, y = static_cast<double>(at->y()) - 0.5;
      const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
      const double u = x - x0, v = y - y0;
      const double expected = (1 - v) * ((1 - u) * source.At(x0, y0) + u * source.At(x0 + 1, y0)) +
                              v * ((1 - u) * source.At(x0, y0 + 1) + u * source.At(x0 + 1, y0 + 1));
      // Weights are cut to 256ths: up to 255 / 256 twice, and half for rounding.
      ASSERT_NEAR(value, std::max(1.0, expected), 2.51) << i << " " << j;
      ++num_inside;
    }
  }
  EXPECT_GT(num_inside, 131 * 97 / 2);
  EXPECT_LE(num_wrong_rim, 1);
}

}  // namespace
}  // namespace colmap_seapoint
