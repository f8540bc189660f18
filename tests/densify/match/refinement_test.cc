#include "densify/match/refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "tests/synthetic/noise_texture.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 330, kHeight = 150;

// Two rectified pictures of a world of surfaces, each with a disparity that is a function of where
// picture 2 sees it, so that picture 1 is exact too: x1 = x2 + d(x2, y).
class RectWorld {
 public:
  using Surface = std::function<std::optional<double>(double x2, double y)>;

  explicit RectWorld(std::vector<Surface> surfaces) : surfaces_(std::move(surfaces)) {
    for (RectPicture* picture : {&picture1, &picture2}) {
      picture->window = {picture == &picture1 ? 40 : 10, 7, kWidth, kHeight};
      picture->gray = GrayImage(kWidth, kHeight);
      picture->gray.data.resize(picture->gray.data.size() + RectPicture::kSlack);
      for (int j = 0; j < kHeight; ++j) {
        for (int i = 0; i < kWidth; ++i) {
          const double x = picture->window.x0 + i + 0.5, y = picture->window.y0 + j + 0.5;
          const Seen seen = picture == &picture1 ? See1(x, y) : See2(x, y);
          const NoiseTexture texture(static_cast<uint32_t>(5 + seen.surface), 7, 3);
          const double value = 128 + 110 * texture.At({seen.x2, y, 0});
          picture->gray.At(i, j) = static_cast<uint8_t>(std::clamp(value, 1.0, 255.0));
        }
      }
    }
  }

  // True disparity at a pixel of picture 1's window; 0 where picture 2 does not see the place.
  double Truth(int i, int j) const {
    const double x = picture1.window.x0 + i + 0.5, y = picture1.window.y0 + j + 0.5;
    const Seen seen = See1(x, y);
    const double x2 = seen.x2 - picture2.window.x0;
    const bool hidden = See2(seen.x2, y).surface != seen.surface;
    return x2 < 0 || x2 >= kWidth || hidden ? 0 : x - seen.x2;
  }

  // Exact disparities at the nodes.
  PartialDisparity Nodes() const {
    PartialDisparity nodes;
    nodes.grid = SampleGrid(picture1.window, kMinNodeStep);
    nodes.disparity.assign(nodes.grid.Size(), 0);
    nodes.score.assign(nodes.grid.Size(), 0.9f);
    for (int b = 0; b < nodes.grid.height; ++b) {
      for (int a = 0; a < nodes.grid.width; ++a) {
        const int i = nodes.grid.PixelX(a), j = nodes.grid.PixelY(b);
        if (i >= kWidth || j >= kHeight) continue;
        nodes.disparity[static_cast<size_t>(b * nodes.grid.width + a)] =
            static_cast<float>(Truth(i, j));
      }
    }
    return nodes;
  }

  PartialDisparity Run(const PartialDisparity& nodes, int step, int num_threads = 2,
                       int window = 9) const {
    return Refine(picture1, picture2, Open(), nodes, {window, 0.7f, step}, num_threads);
  }

  Gate Open() const { return Gate(picture1.window, kMinNodeStep, Gate::kOpen); }

  RectPicture picture1, picture2;

 private:
  struct Seen {
    double x2 = 0;
    int surface = 0;
  };

  // The nearest surface: the largest disparity.
  Seen See2(double x2, double y) const {
    Seen seen;
    double best = -1;
    for (size_t s = 0; s < surfaces_.size(); ++s) {
      const auto d = surfaces_[s](x2, y);
      if (d && *d > best) {
        best = *d;
        seen = {x2, static_cast<int>(s)};
      }
    }
    return seen;
  }

  Seen See1(double x1, double y) const {
    Seen seen;
    double best = -1;
    for (size_t s = 0; s < surfaces_.size(); ++s) {
      double x2 = x1;  // x2 + d(x2) = x1: slopes are small
      std::optional<double> d;
      for (int iteration = 0; iteration < 60; ++iteration) {
        d = surfaces_[s](x2, y);
        x2 = x1 - d.value_or(40);
      }
      if (d && *d > best) {
        best = *d;
        seen = {x2, static_cast<int>(s)};
      }
    }
    return seen;
  }

  std::vector<Surface> surfaces_;
};

RectWorld Plane() {
  return RectWorld({[](double x, double y) { return 40 + 0.15 * (x - 150) - 0.1 * (y - 70); }});
}

// A level at disparity 25 and a nearer one, 40, left or right of the edge.
RectWorld Step(bool near_is_right) {
  return RectWorld({[](double, double) { return 25.0; },
                    [near_is_right](double x, double) {
                      return (x > 160) == near_is_right ? std::optional(40.0) : std::nullopt;
                    }});
}

struct Errors {
  double found = 0;          // share of what can be
  double mean = 0, rms = 0;  // pixels of disparity
};

// Of the samples at least `margin` pixels inside picture 1 whose place picture 2 sees as far
// inside.
Errors Measure(const RectWorld& world, const PartialDisparity& result, int margin) {
  Errors errors;
  double num_true = 0, num_found = 0, sum = 0, sum_squares = 0;
  for (int b = 0; b < result.grid.height; ++b) {
    for (int a = 0; a < result.grid.width; ++a) {
      const int i = result.grid.PixelX(a), j = result.grid.PixelY(b);
      if (std::min({i, j, kWidth - 1 - i, kHeight - 1 - j}) < margin) continue;
      const double truth = world.Truth(i, j);
      const double i2 = i + world.picture1.window.x0 - world.picture2.window.x0 - truth;
      if (truth == 0 || i2 < margin || i2 >= kWidth - margin) continue;
      ++num_true;
      const float d = result.disparity[static_cast<size_t>(b * result.grid.width + a)];
      if (d <= 0) continue;
      ++num_found;
      sum += d - truth;
      sum_squares += (d - truth) * (d - truth);
    }
  }
  errors.found = num_found / num_true;
  errors.mean = sum / num_found;
  errors.rms = std::sqrt(sum_squares / num_found);
  return errors;
}

TEST(RefinementTest, TiltedPlane) {
  const RectWorld world = Plane();
  for (const int step : {1, 2, 3, 4}) {
    for (const int window : {5, 9, 15}) {
      const PartialDisparity result = world.Run(world.Nodes(), step, 2, window);
      EXPECT_EQ(result.grid.step, step);
      EXPECT_EQ(result.disparity.size(), result.grid.Size());
      const Errors errors = Measure(world, result, window / 2 + 4);
      EXPECT_GE(errors.found, 0.999) << step << " " << window;
      // Larger windows average more noise (of rounding to grey levels) out; none is biased.
      EXPECT_LT(errors.rms, window == 5   ? 0.12
                            : window == 9 ? 0.06
                                          : 0.03)
          << step << " " << window;
      EXPECT_LT(std::abs(errors.mean), 0.003) << step << " " << window;
    }
  }
}

// Nothing that picture 2 does not show, and no score without a disparity.
TEST(RefinementTest, NothingBeyondThePictures) {
  const RectWorld world = Plane();
  for (const int step : {1, 2, 3, 4, 7}) {
    const PartialDisparity result = world.Run(world.Nodes(), step);
    for (int b = 0; b < result.grid.height; ++b) {
      for (int a = 0; a < result.grid.width; ++a) {
        const size_t sample = static_cast<size_t>(b * result.grid.width + a);
        const float d = result.disparity[sample];
        ASSERT_EQ(d > 0, result.score[sample] >= 0.7f);
        if (d <= 0) continue;
        const int i = result.grid.PixelX(a), j = result.grid.PixelY(b);
        ASSERT_TRUE(i >= 2 && j >= 2 && i < kWidth - 2 && j < kHeight - 2);
        const float i2 = static_cast<float>(i + 30) - d;
        ASSERT_TRUE(i2 >= 2 && i2 < kWidth - 2) << i << " " << j;
      }
    }
  }
}

// Each side of the edge has its own level's disparity, up to the edge; what is hidden in picture 2
// (15 pixels left of the edge when the near level is on the right) is not invented.
TEST(RefinementTest, TwoLevelsMeetAtTheEdge) {
  for (const bool near_is_right : {false, true}) {
    const RectWorld world = Step(near_is_right);
    const PartialDisparity result = world.Run(world.Nodes(), 1);
    int num_wrong = 0, num_missing = 0, num_near = 0, num_hidden = 0, num_invented = 0;
    for (int j = 8; j < kHeight - 8; ++j) {
      for (int i = 120; i < 220; ++i) {
        const float d = result.disparity[static_cast<size_t>(j * kWidth + i)];
        const double truth = world.Truth(i, j);
        if (truth == 0) {
          ++num_hidden;
          num_invented += d > 0;
          continue;
        }
        ++num_near;
        num_missing += d <= 0;
        num_wrong += d > 0 && std::abs(d - truth) > 1;
      }
    }
    EXPECT_LT(num_missing, 3 * (kHeight - 16));  // pixels a row
    EXPECT_LT(num_wrong, 0.005 * num_near);
    EXPECT_LE(num_invented, 0.04 * num_hidden);
    EXPECT_EQ(num_hidden > 0, near_is_right);
  }
}

// A hole in the nodes is filled from its rim, four nodes deep and no deeper.
TEST(RefinementTest, HolesFillFromTheirRim) {
  const RectWorld world = Plane();
  constexpr int kLeft = 30, kTop = 8, kRight = 55, kBottom = 30;  // nodes, the last one beyond
  PartialDisparity nodes = world.Nodes();
  for (int b = kTop; b < kBottom; ++b) {
    for (int a = kLeft; a < kRight; ++a) {
      nodes.disparity[static_cast<size_t>(b * nodes.grid.width + a)] = 0;
    }
  }
  for (const int step : {1, 2, 4}) {
    const PartialDisparity result = world.Run(nodes, step);
    const SampleGrid& grid = result.grid;
    int num_deep = 0, num_rim = 0;
    for (int b = grid.FirstFrom(kTop * kMinNodeStep); b < grid.FirstFrom(kBottom * kMinNodeStep);
         ++b) {
      for (int a = grid.FirstFrom(kLeft * kMinNodeStep); a < grid.FirstFrom(kRight * kMinNodeStep);
           ++a) {
        const int u = grid.PixelX(a) / kMinNodeStep, v = grid.PixelY(b) / kMinNodeStep;
        const int depth = 1 + std::min({u - kLeft, v - kTop, kRight - 1 - u, kBottom - 1 - v});
        const float d = result.disparity[static_cast<size_t>(b * grid.width + a)];
        if (depth > kMaxRefinementSpread) {
          ++num_deep;
          ASSERT_EQ(d, 0) << u << " " << v;
        } else {
          ++num_rim;
          ASSERT_NEAR(d, world.Truth(grid.PixelX(a), grid.PixelY(b)), 0.35) << u << " " << v;
        }
      }
    }
    EXPECT_GT(num_deep, 100);
    EXPECT_GT(num_rim, 200);
  }
}

TEST(RefinementTest, NoNodesNoSamples) {
  const RectWorld world = Plane();
  PartialDisparity nodes = world.Nodes();
  std::fill(nodes.disparity.begin(), nodes.disparity.end(), 0.0f);
  nodes.num_failed_seeds = 5;
  const PartialDisparity result = world.Run(nodes, 1);
  EXPECT_EQ(*std::max_element(result.disparity.begin(), result.disparity.end()), 0);
  EXPECT_EQ(result.num_failed_seeds, 5);
}

// Even where every match is good enough, a sample that has none gets no disparity.
TEST(RefinementTest, NoMatchIsNoDisparityWhateverTheLimit) {
  RectWorld world = Plane();
  for (RectPicture* picture : {&world.picture1, &world.picture2}) {
    for (int j = 0; j < kHeight; ++j) {
      std::fill_n(picture->gray.Row(j) + 100, 100, uint8_t{90});  // no texture
    }
  }
  const PartialDisparity result =
      Refine(world.picture1, world.picture2, world.Open(), world.Nodes(), {9, 0, 2}, 2);
  int num_without = 0;
  for (int b = 0; b < result.grid.height; ++b) {
    for (int a = 0; a < result.grid.width; ++a) {
      const size_t sample = static_cast<size_t>(b * result.grid.width + a);
      const int i = result.grid.PixelX(a);
      ASSERT_EQ(result.disparity[sample] > 0, result.score[sample] > 0);
      if (i < 104 || i >= 196) continue;
      ASSERT_EQ(result.disparity[sample], 0);
      ++num_without;
    }
  }
  EXPECT_GT(num_without, 2000);
}

TEST(RefinementTest, SameWithAnyNumberOfThreads) {
  const RectWorld world = Step(true);
  PartialDisparity nodes = world.Nodes();
  for (size_t n = 0; n < nodes.disparity.size(); n += 7) nodes.disparity[n] = 0;
  for (int b = 10; b < 28; ++b) {
    for (int a = 10; a < 40; ++a)
      nodes.disparity[static_cast<size_t>(b * nodes.grid.width + a)] = 0;
  }
  const PartialDisparity one = world.Run(nodes, 1, 1);
  for (const int num_threads : {2, 5}) {
    const PartialDisparity many = world.Run(nodes, 1, num_threads);
    EXPECT_EQ(many.disparity, one.disparity);
    EXPECT_EQ(many.score, one.score);
  }
}

}  // namespace
}  // namespace colmap_seapoint
