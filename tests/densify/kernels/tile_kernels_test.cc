#include "densify/kernels/tile_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/vector_targets.h"

namespace colmap_seapoint {
namespace {

using tile::kReach;
using tile::Pair;
using tile::Prediction;
using tile::Region;

constexpr int kOutside = -1000;  // a pixel that is not there

// The definition of tile::Match, a window at a time.
class Oracle {
 public:
  struct Answer {
    float residual = 0, score = 0, deviation = 0;
    bool whole = true;  // the windows behind the answer have all their pixels
  };

  Oracle(const Pair& pair, const Region& region, const Prediction& prediction)
      : pair_(pair), region_(region), prediction_(prediction), half_(pair.window / 2) {}

  Answer At(int x, int y) const {
    std::array<float, 2 * kReach + 1> score;
    std::array<bool, 2 * kReach + 1> usable;
    for (int shift = -kReach; shift <= kReach; ++shift) {
      const size_t k = static_cast<size_t>(shift + kReach);
      usable[k] = Zncc(x, y, shift, &score[k]);
    }
    Answer answer;
    for (int shift = 1 - kReach; shift < kReach; ++shift) {
      const size_t k = static_cast<size_t>(shift + kReach);
      if (!usable[k - 1] || !usable[k] || !usable[k + 1] || score[k] <= answer.score) continue;
      if (score[k] < score[k - 1] || score[k] < score[k + 1]) continue;
      answer.score = score[k];
      const float curvature = (score[k - 1] + score[k + 1]) - (score[k] + score[k]);
      const float top =
          static_cast<float>(shift) + 0.5f * (score[k - 1] - score[k + 1]) / curvature;
      const float slope = 0.5f * (tile::PredictedAt(prediction_, x + 1, y) -
                                  tile::PredictedAt(prediction_, x - 1, y));
      answer.residual = top * (1 - slope);
      const float doubt =
          2 * std::max(0.0f, 1 - score[k]) / static_cast<float>(pair_.window * pair_.window);
      answer.deviation = std::sqrt(doubt / -curvature) * (1 - slope);
      answer.whole = Whole(x, y, shift - 1) && Whole(x, y, shift) && Whole(x, y, shift + 1);
      if (!(curvature < 0)) answer = Answer();
    }
    return answer;
  }

 private:
  // Picture 1 at a pixel of the tile.
  int Left(int x, int y) const {
    const int column = region_.tile_x + x, row = region_.tile_y + y;
    if (!pair_.gray1->Contains(column, row) || pair_.gray1->At(column, row) == 0) return kOutside;
    return pair_.gray1->At(column, row);
  }

  // Picture 2 where the prediction puts a pixel of the tile: Catmull-Rom at the nearest 64th of a
  // pixel, weights in 64ths.
  int Warped(int x, int y) const {
    const int row = region_.tile_y + y + pair_.row_shift;
    const float column = static_cast<float>(region_.tile_x + x + pair_.column_shift);
    const float at = column - tile::PredictedAt(prediction_, x, y);
    if (!(at >= 1 && at < static_cast<float>(pair_.gray2->width - 2))) return kOutside;
    const int nearest = static_cast<int>(std::floor(64 * at + 0.5f));
    const int fixed = std::min(nearest, 64 * (pair_.gray2->width - 2) - 1);
    const int whole = fixed / 64, phase = fixed % 64;
    const double t = phase / 64.0;
    const std::array<double, 4> exact = {
        -0.5 * t + t * t - 0.5 * t * t * t, 1 - 2.5 * t * t + 1.5 * t * t * t,
        0.5 * t + 2 * t * t - 1.5 * t * t * t, -0.5 * t * t + 0.5 * t * t * t};
    std::array<int, 4> weight;
    for (size_t k = 0; k < 4; ++k) weight[k] = static_cast<int>(std::lround(64 * exact[k]));
    weight[phase < 32 ? 1 : 2] += 64 - weight[0] - weight[1] - weight[2] - weight[3];
    int sum = 32;
    for (int k = 0; k < 4; ++k) {
      const int source = whole - 1 + k;
      if (!pair_.gray2->Contains(source, row) || pair_.gray2->At(source, row) == 0) return kOutside;
      sum += weight[static_cast<size_t>(k)] * pair_.gray2->At(source, row);
    }
    return std::clamp(sum >> 6, 1, 255);
  }

  bool Whole(int x, int y, int shift) const {
    for (int v = -half_; v <= half_; ++v) {
      for (int u = -half_; u <= half_; ++u) {
        if (Left(x + u, y + v) == kOutside || Warped(x + u - shift, y + v) == kOutside)
          return false;
      }
    }
    return true;
  }

  // False where a corner of either window is missing or one has no texture. Missing pixels that are
  // no corners count as 0, black.
  bool Zncc(int x, int y, int shift, float* score) const {
    int64_t s1 = 0, s2 = 0, s11 = 0, s12 = 0, s22 = 0;
    const int64_t n = pair_.window * pair_.window;
    for (int v = -half_; v <= half_; ++v) {
      for (int u = -half_; u <= half_; ++u) {
        const int left = Left(x + u, y + v), warped = Warped(x + u - shift, y + v);
        const bool corner = std::abs(u) == half_ && std::abs(v) == half_;
        if (corner && (left == kOutside || warped == kOutside)) return false;
        const int64_t a = std::max(0, left), b = std::max(0, warped);
        s1 += a;
        s2 += b;
        s11 += a * a;
        s12 += a * b;
        s22 += b * b;
      }
    }
    const int64_t scatter1 = n * s11 - s1 * s1, scatter2 = n * s22 - s2 * s2;
    if (scatter1 < n * n || scatter2 < n * n) return false;
    *score = static_cast<float>(n * s12 - s1 * s2) * (1 / std::sqrt(static_cast<float>(scatter1))) *
             (1 / std::sqrt(static_cast<float>(scatter2)));
    return true;
  }

  const Pair pair_;
  const Region region_;
  const Prediction& prediction_;
  const int half_;
};

// Random grey values, smooth over about two pixels; 0 in a rim of random widths if there is one.
GrayImage RandomPicture(int width, int height, bool has_rim, std::mt19937* generator) {
  GrayImage noise(width + 2, height + 2), picture(width, height);
  for (uint8_t& value : noise.data) value = static_cast<uint8_t>((*generator)() >> 24);
  int rim[4];
  for (int& size : rim) size = has_rim ? static_cast<int>((*generator)() % 9) : 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int sum = 2 * noise.At(x, y) + noise.At(x + 1, y) + noise.At(x, y + 1);
      const bool inside = x >= rim[0] && y >= rim[1] && x < width - rim[2] && y < height - rim[3];
      picture.At(x, y) = static_cast<uint8_t>(inside ? std::max(1, sum / 4) : 0);
    }
  }
  picture.data.resize(picture.data.size() + 16);
  return picture;
}

// Picture 1 such that something matches: picture 2 where the prediction puts it, less a pixel or
// more a pixel or so, and noise.
void PaintMatches(const Region& region, const Prediction& prediction, const Pair& pair,
                  GrayImage* gray1, std::mt19937* generator) {
  for (int y = 0; y < gray1->height; ++y) {
    for (int x = 0; x < gray1->width; ++x) {
      if (gray1->At(x, y) == 0) continue;
      const float at = static_cast<float>(x + pair.column_shift) -
                       tile::PredictedAt(prediction, x - region.tile_x, y - region.tile_y);
      const int column = static_cast<int>(std::lround(at)) + x / 16 % 4 - 1,
                row = y + pair.row_shift;
      if (!pair.gray2->Contains(column, row)) continue;
      const int noise = static_cast<int>((*generator)() % 21);
      gray1->At(x, y) = static_cast<uint8_t>(
          std::clamp(pair.gray2->At(column, row) * 3 / 4 + 20 + noise, 1, 255));
    }
  }
}

struct Case {
  GrayImage gray1, gray2;
  Pair pair;
  Region region;
  Prediction prediction;

  // A plane; bumpy: every node off it by up to 0.6 pixels.
  Case(int window, bool has_rim, bool bumpy, std::mt19937* generator) {
    const auto random = [&](int low, int high) {
      return low + static_cast<int>((*generator)() % static_cast<unsigned>(high - low + 1));
    };
    gray2 = RandomPicture(random(100, 140), random(50, 70), has_rim, generator);
    gray1 = RandomPicture(random(100, 140), random(50, 70), has_rim, generator);
    pair = {&gray1, &gray2, random(-30, 30), random(-6, 6), window};
    region.tile_x = random(-1, 2) * tile::kWidth / 2;
    region.tile_y = random(-1, 2) * tile::kHeight / 2;
    region.x0 = random(-4, 15) * 2;
    region.y0 = random(-4, 7) * 2;
    region.width = random(1, tile::kWidth);
    region.height = random(1, tile::kHeight);
    region.row_step = random(1, 4);
    region.first_row = random(0, std::min(3, region.height - 1));
    const float center = static_cast<float>(pair.column_shift + random(-40, 40));
    const float slope_x = static_cast<float>(random(-40, 40)) * 0.02f;
    const float slope_y = static_cast<float>(random(-40, 40)) * 0.02f;
    prediction.node_step = random(0, 1) ? kMinNodeStep : kMaxNodeStep;
    const float step = static_cast<float>(prediction.node_step);
    for (size_t b = 0; b < prediction.disparity.size(); ++b) {
      for (size_t a = 0; a < prediction.disparity[b].size(); ++a) {
        const float bump = bumpy ? static_cast<float>(random(-30, 30)) * 0.02f : 0;
        prediction.disparity[b][a] = center + bump + step * slope_x * (static_cast<float>(a) - 5) +
                                     step * slope_y * (static_cast<float>(b) - 3);
      }
    }
    PaintMatches(region, prediction, pair, &gray1, generator);
  }
};

// Residuals, scores and deviations of the windows asked for, row by row.
std::vector<float> MatchAll(const Case& c) {
  alignas(64) std::array<float, tile::kRowStride * tile::kWideHeight> residual, score, deviation;
  tile::Match(c.pair, c.region, c.prediction, {residual.data(), score.data(), deviation.data()});
  std::vector<float> all;
  size_t row = 0;
  for (int y = c.region.first_row; y < c.region.height; y += c.region.row_step, ++row) {
    for (size_t x = 0; x < static_cast<size_t>(c.region.width); ++x) {
      all.push_back(residual[row * tile::kRowStride + x]);
      all.push_back(score[row * tile::kRowStride + x]);
      all.push_back(deviation[row * tile::kRowStride + x]);
    }
  }
  return all;
}

TEST(TileKernelsTest, EqualsTheDefinitionWithAnyVectors) {
  std::mt19937 generator(7);
  int num_found = 0, num_not = 0;
  for (int trial = 0; trial < 240; ++trial) {
    SCOPED_TRACE(trial);
    const bool bumpy = trial % 3 != 0;
    const Case c(5 + 2 * (trial % 6), trial % 4 != 0, bumpy, &generator);
    const Oracle oracle(c.pair, c.region, c.prediction);
    const std::vector<float> all = MatchAll(c);
    ForEachVectorTarget([&] { ASSERT_EQ(MatchAll(c), all); });
    size_t next = 0;
    for (int y = c.region.first_row; y < c.region.height; y += c.region.row_step) {
      for (int x = 0; x < c.region.width; ++x, next += 3) {
        const Oracle::Answer answer = oracle.At(c.region.x0 + x, c.region.y0 + y);
        ASSERT_NEAR(all[next + 1], answer.score, 1e-5) << x << " " << y;
        ASSERT_NEAR(all[next], answer.residual, 1e-5) << x << " " << y;
        // Where the peak is nearly flat, roundings of its scores count.
        ASSERT_NEAR(all[next + 2], answer.deviation, 1e-5 + 1e-3 * answer.deviation)
            << x << " " << y;
        ++(answer.score > 0 ? num_found : num_not);
        // Along a plane the corners tell whether a window lies in upright pictures.
        if (!bumpy) {
          ASSERT_TRUE(answer.whole) << x << " " << y;
        }
      }
    }
  }
  EXPECT_GT(num_found, 5000);
  EXPECT_GT(num_not, 5000);
}

TEST(TileKernelsTest, LargestWindowsDoNotOverflow) {
  std::mt19937 generator(1);
  Case c(15, false, false, &generator);
  for (size_t i = 0; i < c.gray1.data.size(); ++i) c.gray1.data[i] = i / 3 % 2 ? 255 : 1;
  c.gray2 = c.gray1;
  c.pair.column_shift = c.pair.row_shift = 0;
  c.region = {0, 0, 12, 10, 64, 20, 0, 1};
  for (auto& row : c.prediction.disparity) row.fill(0);
  ForEachVectorTarget([&] {
    const std::vector<float> all = MatchAll(c);
    for (size_t i = 0; i < all.size(); i += 3) {
      ASSERT_FLOAT_EQ(all[i + 1], 1);
      ASSERT_NEAR(all[i], 0, 0.01);
      ASSERT_LT(all[i + 2], 1e-3);
    }
  });
}

double Median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

// Noise of its own in each pixel of both pictures, on a texture that is known: the deviation
// follows it, and is how far the residuals scatter about the true shift, 0, to a factor of two:
// textures are no parabolas.
TEST(TileKernelsTest, TheDeviationIsWhatResidualsScatter) {
  double before = 0;
  for (const double noise : {4.0, 8.0, 16.0}) {
    std::mt19937 generator(5);
    std::normal_distribution<double> normal(0, noise);
    Case c(9, false, false, &generator);
    const GrayImage texture = RandomPicture(160, 90, false, &generator);
    const auto noisy = [&] {
      GrayImage picture = texture;
      for (uint8_t& value : picture.data) {
        value = static_cast<uint8_t>(std::clamp(value + std::lround(normal(generator)), 1l, 255l));
      }
      return picture;
    };
    c.gray1 = noisy();
    c.gray2 = noisy();
    c.pair.column_shift = c.pair.row_shift = 0;
    c.region = {20, 20, 10, 10, 64, 32, 0, 1};
    for (auto& row : c.prediction.disparity) row.fill(0);
    const std::vector<float> all = MatchAll(c);
    std::vector<float> residuals, deviations;
    for (size_t i = 0; i < all.size(); i += 3) {
      residuals.push_back(std::abs(all[i]));
      deviations.push_back(all[i + 2]);
    }
    const double scatter = Median(residuals) / 0.6745;  // of a normal distribution
    const double deviation = Median(deviations);
    EXPECT_GT(deviation, 0.5 * scatter) << noise;
    EXPECT_LT(deviation, 2 * scatter) << noise;
    if (before > 0) {
      EXPECT_NEAR(deviation / before, 2, 0.1);
    }
    before = deviation;
  }
}

// The parts of picture 2 that it is asked for lie wholly beyond it, on any side.
TEST(TileKernelsTest, NothingMatchesBeyondThePicture) {
  std::mt19937 generator(2);
  for (const float disparity : {-500.0f, 500.0f, -1e6f, 1e6f}) {
    Case c(7, false, false, &generator);
    for (auto& row : c.prediction.disparity) row.fill(disparity);
    c.pair.column_shift = 0;
    ForEachVectorTarget([&] {
      for (const float value : MatchAll(c)) ASSERT_EQ(value, 0);
    });
  }
}

}  // namespace
}  // namespace colmap_seapoint
