#include "examples/survey/scene/seabed.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/parallel.h"
#include "examples/survey/scene/stones.h"

namespace colmap_seapoint {
namespace {

// The fields that both heights and colours depend on.
struct Ground {
  Field rock;       // 0 sand ... 1 rock
  Field roughness;  // deviation 1
  StoneLayer stones;
};

enum Purpose : int64_t {
  kRock = 1,
  kRoughness,
  kStones,
  kHills,
  kCrags,
  kLedges,
  kLedgeEdges,
  kRipples,
  kSandHeight,
  kFine,
  kMottle,
  kCrust,
  kTurf,
  kTufts,
  kSponge,
  kSpots,
};

Ground MakeGround(const GridSpec& grid, uint64_t seed) {
  Ground ground;
  ground.rock = MakeFbm(grid, {2.3, 0.012, 0.55f}, Hash(seed, kRock));
  for (float& value : ground.rock) value = SmoothStep(-0.55f, -0.15f, value);
  ground.roughness = MakeFbm(grid, {0.19, 0.012, 0.6f}, Hash(seed, kRoughness));
  ground.stones = MakeStones(grid, ground.roughness, Hash(seed, kStones));
  return ground;
}

// Steps 1 high with steep fronts, flat between.
float Terrace(float s) {
  const float floor = std::floor(s);
  return floor + 0.12f * (s - floor) + 0.88f * SmoothStep(0.455f, 0.545f, s - floor);
}

// Sharp crests, round troughs, 0 ... 1.
float Ripple(float phase) { return 1 - std::sqrt(std::abs(std::sin(phase)) + 0.02f); }

Albedo Blend(const Albedo& a, const Albedo& b, float weight) {
  return {Mix(a.red, b.red, weight), Mix(a.green, b.green, weight), Mix(a.blue, b.blue, weight)};
}

Albedo Scale(const Albedo& a, float factor) {
  return {a.red * factor, a.green * factor, a.blue * factor};
}

// Linear reflectance.
constexpr Albedo kSand = {0.40f, 0.36f, 0.28f};
constexpr Albedo kStone = {0.25f, 0.24f, 0.21f};
constexpr Albedo kPinkCrust = {0.40f, 0.24f, 0.30f};
constexpr Albedo kTurfAlgae = {0.085f, 0.080f, 0.045f};
constexpr Albedo kTuftTips = {0.33f, 0.30f, 0.20f};
constexpr Albedo kOrangeSponge = {0.55f, 0.21f, 0.07f};
constexpr Albedo kShell = {0.75f, 0.72f, 0.66f};

}  // namespace

Field Seabed::MakeHeights(const GridSpec& grid) const {
  const uint64_t seed = options_.seed;
  const double finest = std::max(0.008, 3 * options_.cell);
  const Ground ground = MakeGround(grid, seed);
  const Field hills = MakeFbm(grid, {5.5, 0.9, 0.5f}, Hash(seed, kHills));
  const Field crags = MakeFbm(grid, {0.8, finest, 0.47f}, Hash(seed, kCrags));
  const Field ledges = MakeFbm(grid, {3.7, 1.5, 0.5f}, Hash(seed, kLedges));
  const Field edges = MakeFbm(grid, {0.6, finest, 0.5f}, Hash(seed, kLedgeEdges));
  const Field ripples = MakeFbm(grid, {1.3, 0.3, 0.5f}, Hash(seed, kRipples));
  const Field sand = MakeFbm(grid, {0.3, finest, 0.55f}, Hash(seed, kSandHeight));
  Field heights(grid.Size());
  for (int j = 0; j < grid.ny; ++j) {
    for (int i = 0; i < grid.nx; ++i) {
      const size_t n =
          static_cast<size_t>(j) * static_cast<size_t>(grid.nx) + static_cast<size_t>(i);
      const float rock = ground.rock[n];
      const float phase = static_cast<float>(
          std::fmod((0.8 * grid.X(i) + 0.6 * grid.Y(j)) * 24, 6.283185307179586));
      const float on_rock =
          0.05f + 0.024f * crags[n] + 0.13f * Terrace(1.1f * ledges[n] + 0.10f * edges[n]);
      const float on_sand = 0.012f * Ripple(phase + 1.4f * ripples[n]) + 0.0016f * sand[n];
      const float height = 0.07f * hills[n] + Mix(on_sand, on_rock, rock) +
                           ground.stones.height[n] * (1 + 0.06f * crags[n]);
      heights[n] = static_cast<float>(options_.relief) * height;
    }
  }
  return heights;
}

std::vector<Albedo> Seabed::MakeAlbedo(const GridSpec& grid) const {
  const uint64_t seed = options_.seed;
  const double finest = 2 * grid.step;
  const Ground ground = MakeGround(grid, seed);
  const Field fine = MakeFbm(grid, {0.03, finest, 0.85f}, Hash(seed, kFine));
  const Field mottle = MakeFbm(grid, {0.9, 0.02, 0.72f}, Hash(seed, kMottle));
  const Field crust = MakeFbm(grid, {1.2, 0.006, 0.62f}, Hash(seed, kCrust));
  const Field turf = MakeFbm(grid, {1.6, 0.008, 0.66f}, Hash(seed, kTurf));
  const Field tufts = MakeFbm(grid, {0.045, finest, 0.8f}, Hash(seed, kTufts));
  const Field sponge = MakeFbm(grid, {0.55, 0.012, 0.5f}, Hash(seed, kSponge));
  const Field spots = MakeSpots(grid, ground.roughness, Hash(seed, kSpots));
  std::vector<Albedo> albedo(grid.Size());
  for (size_t n = 0; n < albedo.size(); ++n) {
    Albedo sand = Scale(kSand, 1 + 0.13f * fine[n] + 0.08f * mottle[n]);
    sand = Blend(sand, kTurfAlgae, 0.55f * SmoothStep(1.6f, 2.3f, fine[n]));
    sand = Blend(sand, kShell, 0.8f * SmoothStep(2.1f, 2.6f, tufts[n]));

    const float contrast = std::exp(0.42f * mottle[n] + 0.36f * fine[n]);
    Albedo rock = Scale(kStone, contrast);
    const Albedo pink = Scale(kPinkCrust, 1 + 0.22f * fine[n] + 0.2f * mottle[n]);
    rock = Blend(rock, pink, 0.85f * SmoothStep(0.15f, 0.4f, crust[n]));
    const Albedo algae = Blend(kTurfAlgae, kTuftTips, SmoothStep(-0.6f, 1.8f, tufts[n]));
    rock = Blend(rock, algae, 0.92f * SmoothStep(-0.1f, 0.45f, turf[n] + 0.25f * tufts[n]));
    const Albedo orange = Scale(kOrangeSponge, 1 + 0.2f * fine[n]);
    rock = Blend(rock, orange, 0.9f * SmoothStep(2.0f, 2.15f, sponge[n]));
    rock = Blend(rock, kShell, 0.8f * SmoothStep(2.25f, 2.5f, fine[n]));

    if (spots[n] > 0) {
      rock = Scale(rock, Mix(1, spots[n] * spots[n] * spots[n], 0.8f));
      sand = Scale(sand, Mix(1, spots[n], 0.25f));
    }
    const float tone = ground.stones.tone[n];
    Albedo here = Blend(sand, rock, ground.rock[n]);
    if (tone > 0) here = Blend(Scale(kStone, tone * contrast), rock, 0.55f);
    albedo[n] = {std::clamp(here.red, 0.01f, 0.95f), std::clamp(here.green, 0.01f, 0.95f),
                 std::clamp(here.blue, 0.01f, 0.95f)};
  }
  return albedo;
}

HeightField MakeHeightField(const Seabed& seabed, double min_x, double min_y, double max_x,
                            double max_y, int num_threads) {
  const double cell = seabed.Options().cell;
  GridSpec grid;
  grid.step = cell;
  grid.ix0 = static_cast<int64_t>(std::floor(min_x / cell));
  grid.iy0 = static_cast<int64_t>(std::floor(min_y / cell));
  grid.nx = static_cast<int>(static_cast<int64_t>(std::ceil(max_x / cell)) - grid.ix0) + 1;
  grid.ny = static_cast<int>(static_cast<int64_t>(std::ceil(max_y / cell)) - grid.iy0) + 1;
  constexpr int kBlock = 256;
  const int blocks_x = (grid.nx + kBlock - 1) / kBlock, blocks_y = (grid.ny + kBlock - 1) / kBlock;
  Field heights(grid.Size());
  ParallelFor(num_threads, int64_t{blocks_x} * blocks_y, [&](int64_t block) {
    const int i0 = static_cast<int>(block % blocks_x) * kBlock;
    const int j0 = static_cast<int>(block / blocks_x) * kBlock;
    const GridSpec part{grid.ix0 + i0, grid.iy0 + j0, std::min(kBlock, grid.nx - i0),
                        std::min(kBlock, grid.ny - j0), cell};
    const Field values = seabed.MakeHeights(part);
    for (int j = 0; j < part.ny; ++j) {
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(j) * part.nx, part.nx,
                  heights.begin() + (static_cast<std::ptrdiff_t>(j0) + j) * grid.nx + i0);
    }
  });
  return HeightField(grid, std::move(heights));
}

}  // namespace colmap_seapoint
