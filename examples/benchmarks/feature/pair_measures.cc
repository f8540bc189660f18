#include "examples/benchmarks/feature/pair_measures.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace colmap_seapoint {
namespace {

constexpr double kNoisePercentile = 0.05;
constexpr double kLimitOverNoise = 3;
constexpr double kMinLimit = 1.5;

struct CellSums {
  int64_t count = 0, sum = 0, sum_squares = 0;
  int64_t num_responses = 0, sum_responses = 0;
};

// 6 standard deviations of noise; 0 on planes and on most edges.
int NoiseResponse(const GrayImage& picture, int x, int y) {
  const uint8_t* above = picture.Row(y - 1) + x;
  const uint8_t* here = picture.Row(y) + x;
  const uint8_t* below = picture.Row(y + 1) + x;
  return std::abs(above[-1] - 2 * above[0] + above[1] - 2 * here[-1] + 4 * here[0] - 2 * here[1] +
                  below[-1] - 2 * below[0] + below[1]);
}

std::vector<CellSums> SumCells(const GrayImage& picture, const CellGrid& grid) {
  std::vector<CellSums> cells(grid.Size());
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      CellSums& cell = cells[grid.IndexOf(x, y)];
      const int64_t level = picture.At(x, y);
      ++cell.count;
      cell.sum += level;
      cell.sum_squares += level * level;
      if (x == 0 || y == 0 || x + 1 == picture.width || y + 1 == picture.height) continue;
      ++cell.num_responses;
      cell.sum_responses += NoiseResponse(picture, x, y);
    }
  }
  return cells;
}

}  // namespace

double Median(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double MatchedShare(size_t num_matches, size_t num_points1, size_t num_points2) {
  const size_t num_points = std::min(num_points1, num_points2);
  return num_points == 0 ? 0 : static_cast<double>(num_matches) / static_cast<double>(num_points);
}

InfluenceMask MatchedArea(const CellGrid& grid, size_t num_points1,
                          const std::vector<SeaPoint>& points2, const FeatureMatches& matches,
                          double radius) {
  const std::vector<SeaPointLabel> all_processed(num_points1, SeaPointLabel::kPA);
  return MakeInfluenceMask(grid, points2, matches, {{}, all_processed, {}, {}}, radius);
}

Texture FindTexture(const GrayImage& picture, const CellGrid& grid) {
  const std::vector<CellSums> cells = SumCells(picture, grid);
  std::vector<double> noises;
  for (const CellSums& cell : cells) {
    if (cell.num_responses == 0) continue;
    // The mean of |N(0, sigma)| is sqrt(2 / pi) sigma.
    noises.push_back(std::sqrt(std::acos(-1.0) / 2) / 6 * static_cast<double>(cell.sum_responses) /
                     static_cast<double>(cell.num_responses));
  }
  Texture texture;
  if (!noises.empty()) {
    const auto rank = static_cast<size_t>(kNoisePercentile * static_cast<double>(noises.size()));
    std::nth_element(noises.begin(), noises.begin() + static_cast<std::ptrdiff_t>(rank),
                     noises.end());
    texture.noise = noises[rank];
  }
  texture.limit = std::max(kMinLimit, kLimitOverNoise * texture.noise);
  for (const CellSums& cell : cells) {
    const auto count = static_cast<double>(cell.count);
    const double mean = static_cast<double>(cell.sum) / count;
    const double variance = static_cast<double>(cell.sum_squares) / count - mean * mean;
    texture.textured.push_back(variance > texture.limit * texture.limit ? 1 : 0);
  }
  return texture;
}

}  // namespace colmap_seapoint
