#include "colmap_seapoint/orthomosaic/relief/relief.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/orthomosaic/ground/map_tile.h"
#include "colmap_seapoint/orthomosaic/ground/no_map.h"

namespace colmap_seapoint {
namespace {

// About 110 MB each.
int64_t TilesAtOnce(int num_threads) { return std::min(EffectiveNumThreads(num_threads), 6); }

}  // namespace

void BlockRelief::FindTops() {
  const int nx = static_cast<int>(RegionsX()), ny = (height + kRegionBlocks - 1) / kRegionBlocks;
  region_tops.assign(RegionsX() * static_cast<size_t>(ny), -std::numeric_limits<float>::infinity());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (std::isnan(mean[At(x, y)])) continue;
      for (int i = 0; i < 9; ++i) {
        const int u = x / kRegionBlocks + i % 3 - 1, v = y / kRegionBlocks + i / 3 - 1;
        if (u < 0 || v < 0 || u >= nx || v >= ny) continue;
        float& top = region_tops[static_cast<size_t>(v) * RegionsX() + static_cast<size_t>(u)];
        top = std::max(top, mean[At(x, y)]);
      }
    }
  }
}

double Relief::CellSide(int tile_idx) const {
  return cell_sizes_[static_cast<size_t>(tile_idx)] * grid_.pixel_size;
}

Relief::Relief(const CloudTiles& cloud, const MapGrid& grid, bool fill, int num_threads,
               const std::filesystem::path& folder, const KnownRelief* known)
    : grid_(grid), store_(folder, grid.NumTiles(), 1) {
  blocks_.width = (grid.width + kBlockSize - 1) / kBlockSize;
  blocks_.height = (grid.height + kBlockSize - 1) / kBlockSize;
  blocks_.mean.assign(static_cast<size_t>(blocks_.width) * static_cast<size_t>(blocks_.height),
                      kNoHeight);
  blocks_.lowest = std::numeric_limits<float>::infinity();
  blocks_.highest = -blocks_.lowest;
  if (known != nullptr) TakeOver(*known);
  for (int i = 0; i < grid.NumTiles(); ++i) cell_sizes_.push_back(cloud.CellSize(i));
  OrderedPipeline<ReliefTile>(
      num_threads, grid.NumTiles(), TilesAtOnce(num_threads),
      [&](int64_t i) {
        const int tile = static_cast<int>(i);
        if (known != nullptr && !known->is_wanted[static_cast<size_t>(i)]) return ReliefTile();
        const ReliefOptions options = {cloud.CellSize(tile), grid.pixel_size, cloud.BaseHeight(),
                                       fill};
        return MakeReliefTile(options, cloud.Read(tile), grid.Tile(tile));
      },
      [&](int64_t i, ReliefTile&& tile) { Keep(static_cast<int>(i), tile); });
  store_.Finish();
  blocks_.FindTops();
  if (!(blocks_.lowest <= blocks_.highest)) {
    throw NoMap("the map", "the points of the cloud lie too far apart to make a surface",
                "give a dense cloud, or a larger pixel size");
  }
}

// What is known of tiles that are made is found again.
void Relief::TakeOver(const KnownRelief& known) {
  blocks_.lowest = known.lowest;
  blocks_.highest = known.highest;
  blocks_.mean = known.mean;
  for (int i = 0; i < grid_.NumTiles(); ++i) {
    if (!known.is_wanted[static_cast<size_t>(i)]) continue;
    const MapGrid::Box box = grid_.Tile(i);
    for (int y = box.y / kBlockSize; y * kBlockSize < box.y + box.height; ++y) {
      for (int x = box.x / kBlockSize; x * kBlockSize < box.x + box.width; ++x) {
        blocks_.mean[blocks_.At(x, y)] = kNoHeight;
      }
    }
  }
}

void Relief::Keep(int tile_idx, const ReliefTile& tile) {
  const bool has_surface = std::any_of(tile.surface.data.begin(), tile.surface.data.end(),
                                       [](uint8_t flags) { return flags != 0; });
  if (!has_surface) return;
  store_.Append(tile_idx, tile.heights.data.data(), tile.heights.data.size() * sizeof(float));
  store_.Append(tile_idx, tile.surface.data.data(), tile.surface.data.size());
  AddBlocks(grid_.Tile(tile_idx), tile);
}

void Relief::AddBlocks(const MapGrid::Box& box, const ReliefTile& tile) {
  for (int y = 0; y < box.height; y += kBlockSize) {
    for (int x = 0; x < box.width; x += kBlockSize) {
      double sum = 0;
      int count = 0;
      for (int i = 0; i < kBlockSize * kBlockSize; ++i) {
        const int px = x + i % kBlockSize, py = y + i / kBlockSize;
        if (!tile.surface.Contains(px, py) || tile.surface.At(px, py) == 0) continue;
        const float height = tile.heights.At(px + kReliefMargin, py + kReliefMargin);
        sum += double{height};
        blocks_.lowest = std::min(blocks_.lowest, height);
        blocks_.highest = std::max(blocks_.highest, height);
        ++count;
      }
      if (count == 0) continue;
      blocks_.mean[blocks_.At((box.x + x) / kBlockSize, (box.y + y) / kBlockSize)] =
          static_cast<float>(sum / count);
    }
  }
}

ReliefTile Relief::Read(int tile_idx) const {
  ReliefTile tile;
  if (!HasSurface(tile_idx)) return tile;
  const std::vector<char> bytes = store_.Read<char>(tile_idx);
  const MapGrid::Box box = grid_.Tile(tile_idx);
  tile.heights = FloatImage(box.width + 2 * kReliefMargin, box.height + 2 * kReliefMargin);
  tile.surface = Image<uint8_t>(box.width, box.height);
  const size_t height_bytes = tile.heights.data.size() * sizeof(float);
  SEAPOINT_CHECK(bytes.size() == height_bytes + tile.surface.data.size());
  std::memcpy(tile.heights.data.data(), bytes.data(), height_bytes);
  std::memcpy(tile.surface.data.data(), bytes.data() + height_bytes, tile.surface.data.size());
  return tile;
}

}  // namespace colmap_seapoint
