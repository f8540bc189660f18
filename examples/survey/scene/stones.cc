#include "examples/survey/scene/stones.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

struct SizeClass {
  double spacing;      // metres between the squares
  double probability;  // that a square holds a stone
  double min_radius, max_radius;
};

constexpr SizeClass kStones[] = {
    {1.10, 0.60, 0.09, 0.34}, {0.33, 0.45, 0.025, 0.09}, {0.085, 0.40, 0.006, 0.022}};
constexpr SizeClass kSpots[] = {{0.031, 0.55, 0.002, 0.009}, {0.012, 0.50, 0.001, 0.0035}};

struct Stone {
  double x, y;
  double long_radius, short_radius, height;
  double cos_yaw, sin_yaw;
  float tone;
};

Stone MakeStone(const SizeClass& size, int64_t i, int64_t j, uint64_t hash) {
  const auto random = [&](int k) { return Uniform(Hash(hash, k)); };
  Stone stone;
  stone.x = (static_cast<double>(i) + random(0)) * size.spacing;
  stone.y = (static_cast<double>(j) + random(1)) * size.spacing;
  const double skew = random(2) * random(2);  // many small ones, few large ones
  stone.long_radius = size.min_radius + skew * (size.max_radius - size.min_radius);
  stone.short_radius = stone.long_radius * (0.55 + 0.45 * random(3));
  stone.height = stone.short_radius * (0.35 + 0.5 * random(4));
  const double yaw = 3.141592653589793 * random(5);
  stone.cos_yaw = std::cos(yaw);
  stone.sin_yaw = std::sin(yaw);
  stone.tone = static_cast<float>(std::exp(1.3 * (random(6) - 0.5)));
  return stone;
}

void AddStone(const GridSpec& grid, const Field& roughness, const Stone& stone, StoneLayer* layer) {
  const double reach = 1.5 * stone.long_radius;
  const auto first = [&](double low, int64_t i0) {
    return static_cast<int>(std::clamp<int64_t>(
        static_cast<int64_t>(std::ceil(low / grid.step)) - i0, 0, int64_t{1} << 30));
  };
  const int i_end = std::min(grid.nx, first(stone.x + reach, grid.ix0));
  const int j_end = std::min(grid.ny, first(stone.y + reach, grid.iy0));
  for (int j = first(stone.y - reach, grid.iy0); j < j_end; ++j) {
    for (int i = first(stone.x - reach, grid.ix0); i < i_end; ++i) {
      const double dx = grid.X(i) - stone.x, dy = grid.Y(j) - stone.y;
      const double a = (dx * stone.cos_yaw + dy * stone.sin_yaw) / stone.long_radius;
      const double b = (dy * stone.cos_yaw - dx * stone.sin_yaw) / stone.short_radius;
      const size_t node =
          static_cast<size_t>(j) * static_cast<size_t>(grid.nx) + static_cast<size_t>(i);
      const double rough = std::clamp(1 + 0.22 * roughness[node], 0.5, 1.8);
      const double q = (a * a + b * b) * rough;
      if (q >= 1) continue;
      const float height = static_cast<float>(stone.height * std::pow(1 - q, 0.55));
      if (height <= layer->height[node]) continue;
      layer->height[node] = height;
      layer->tone[node] = stone.tone;
    }
  }
}

template <size_t N>
StoneLayer Scatter(const GridSpec& grid, const Field& roughness, uint64_t seed,
                   const SizeClass (&sizes)[N]) {
  StoneLayer layer{Field(grid.Size(), 0.0f), Field(grid.Size(), 0.0f)};
  for (const SizeClass& size : sizes) {
    const auto square = [&](double x) {
      return static_cast<int64_t>(std::floor(x / size.spacing));
    };
    const double reach = 1.5 * size.max_radius;
    const uint64_t size_seed = Hash(seed, std::lround(1000 * size.spacing));
    for (int64_t j = square(grid.Y(0) - reach); j <= square(grid.Y(grid.ny - 1) + reach); ++j) {
      for (int64_t i = square(grid.X(0) - reach); i <= square(grid.X(grid.nx - 1) + reach); ++i) {
        const uint64_t hash = Hash(size_seed, i, j);
        if (Uniform(hash) < size.probability) {
          AddStone(grid, roughness, MakeStone(size, i, j, hash), &layer);
        }
      }
    }
  }
  return layer;
}

}  // namespace

StoneLayer MakeStones(const GridSpec& grid, const Field& roughness, uint64_t seed) {
  return Scatter(grid, roughness, seed, kStones);
}

Field MakeSpots(const GridSpec& grid, const Field& roughness, uint64_t seed) {
  return Scatter(grid, roughness, seed, kSpots).tone;
}

}  // namespace colmap_seapoint
