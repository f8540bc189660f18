#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "examples/survey/scene/seabed.h"

namespace colmap_seapoint {
namespace {

constexpr int kRow = AlbedoMap::kTileSize + 1;

uint32_t Pack(const Albedo& albedo) {
  const auto bits = [](float v) { return static_cast<uint32_t>(std::sqrt(v) * 1023 + 0.5f); };
  return bits(albedo.red) | bits(albedo.green) << 10 | bits(albedo.blue) << 20;
}

// Adds weight times the texel's square roots.
void AddTexel(uint32_t texel, float weight, float* sum) {
  sum[0] += weight * static_cast<float>(texel & 1023u);
  sum[1] += weight * static_cast<float>(texel >> 10 & 1023u);
  sum[2] += weight * static_cast<float>(texel >> 20);
}

}  // namespace

AlbedoMap::AlbedoMap(const Seabed& seabed, double min_x, double min_y, double max_x, double max_y,
                     size_t max_bytes)
    : seabed_(&seabed),
      texel_size_(0.5 * seabed.Options().cell),
      ix0_(static_cast<int64_t>(std::floor(min_x / texel_size_))),
      iy0_(static_cast<int64_t>(std::floor(min_y / texel_size_))),
      max_tiles_(max_bytes / (sizeof(Texel) * kRow * kRow)) {
  num_tiles_x_ =
      static_cast<int>((std::ceil(max_x / texel_size_) - static_cast<double>(ix0_)) / kTileSize) +
      1;
  num_tiles_y_ =
      static_cast<int>((std::ceil(max_y / texel_size_) - static_cast<double>(iy0_)) / kTileSize) +
      1;
  tiles_.resize(static_cast<size_t>(num_tiles_x_) * static_cast<size_t>(num_tiles_y_));
}

void AlbedoMap::MakeTile(size_t index) {
  const int64_t tx = static_cast<int64_t>(index) % num_tiles_x_;
  const int64_t ty = static_cast<int64_t>(index) / num_tiles_x_;
  const GridSpec grid{ix0_ + tx * kTileSize, iy0_ + ty * kTileSize, kRow, kRow, texel_size_};
  const std::vector<Albedo> albedo = seabed_->MakeAlbedo(grid);
  std::vector<Texel> texels(albedo.size());
  std::transform(albedo.begin(), albedo.end(), texels.begin(), Pack);
  tiles_[index].texels = std::move(texels);
}

void AlbedoMap::Prepare(double min_x, double min_y, double max_x, double max_y, int num_threads) {
  const auto tile = [&](double x, int64_t i0, int num_tiles) {
    const double index = std::floor((x / texel_size_ - static_cast<double>(i0)) / kTileSize);
    return static_cast<int>(std::clamp(index, 0.0, num_tiles - 1.0));
  };
  ++num_uses_;
  std::vector<size_t> missing;
  for (int ty = tile(min_y, iy0_, num_tiles_y_); ty <= tile(max_y, iy0_, num_tiles_y_); ++ty) {
    for (int tx = tile(min_x, ix0_, num_tiles_x_); tx <= tile(max_x, ix0_, num_tiles_x_); ++tx) {
      const size_t index =
          static_cast<size_t>(ty) * static_cast<size_t>(num_tiles_x_) + static_cast<size_t>(tx);
      tiles_[index].last_use = num_uses_;
      if (tiles_[index].texels.empty()) missing.push_back(index);
    }
  }
  DropOldTiles();
  ParallelFor(num_threads, static_cast<int64_t>(missing.size()),
              [&](int64_t k) { MakeTile(missing[static_cast<size_t>(k)]); });
}

void AlbedoMap::DropOldTiles() {
  std::vector<std::pair<int64_t, size_t>> old;
  size_t num_tiles = 0;
  for (size_t i = 0; i < tiles_.size(); ++i) {
    num_tiles += !tiles_[i].texels.empty() || tiles_[i].last_use == num_uses_;
    if (!tiles_[i].texels.empty() && tiles_[i].last_use < num_uses_) {
      old.emplace_back(tiles_[i].last_use, i);
    }
  }
  std::sort(old.begin(), old.end());
  for (const auto& [last_use, index] : old) {
    if (num_tiles <= max_tiles_) break;
    std::vector<Texel>().swap(tiles_[index].texels);
    --num_tiles;
  }
}

Albedo AlbedoMap::At(double x, double y) const {
  const double gx = x / texel_size_ - static_cast<double>(ix0_);
  const double gy = y / texel_size_ - static_cast<double>(iy0_);
  const int i = std::clamp(static_cast<int>(gx), 0, num_tiles_x_ * kTileSize - 1);
  const int j = std::clamp(static_cast<int>(gy), 0, num_tiles_y_ * kTileSize - 1);
  const Tile& tile = tiles_[static_cast<size_t>(j / kTileSize) * static_cast<size_t>(num_tiles_x_) +
                            static_cast<size_t>(i / kTileSize)];
  SEAPOINT_CHECK(!tile.texels.empty());
  const float u = static_cast<float>(gx - i), v = static_cast<float>(gy - j);
  const Texel* top = tile.texels.data() + (j % kTileSize) * kRow + i % kTileSize;
  float sum[3] = {0, 0, 0};
  AddTexel(top[0], (1 - u) * (1 - v), sum);
  AddTexel(top[1], u * (1 - v), sum);
  AddTexel(top[kRow], (1 - u) * v, sum);
  AddTexel(top[kRow + 1], u * v, sum);
  for (float& s : sum) s *= s * (1.0f / (1023.0f * 1023.0f));
  return {sum[0], sum[1], sum[2]};
}

}  // namespace colmap_seapoint
