#include "colmap_seapoint/orthomosaic/continue_map.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/orthomosaic/ground/map_tile.h"

namespace colmap_seapoint {
namespace {

constexpr int kReach = 5;  // blocks: kTileHalo, and the next one, which is blended with

int BlocksOf(int pixels) { return (pixels + kBlockSize - 1) / kBlockSize; }

// Whole blocks from one edge to another one farther out, in units of the map.
int BlocksBeyond(double distance, double pixel_size) {
  return std::max(0, static_cast<int>(std::floor(distance / (kBlockSize * pixel_size))));
}

// Never smaller. A block more or less of margin is not worth it.
MapGrid GrownGrid(const MapGrid& before, const MapGrid& needed, MapGrowth* growth) {
  const double pixel = before.pixel_size;
  growth->left = BlocksBeyond(before.left - needed.left, pixel);
  growth->above = BlocksBeyond(needed.top - before.top, pixel);
  const auto right = [](const MapGrid& grid) { return grid.left + grid.width * grid.pixel_size; };
  const auto bottom = [](const MapGrid& grid) { return grid.top - grid.height * grid.pixel_size; };
  MapGrid grid = before;
  grid.left -= growth->left * kBlockSize * pixel;
  grid.top += growth->above * kBlockSize * pixel;
  grid.width += kBlockSize * (growth->left + BlocksBeyond(right(needed) - right(before), pixel));
  grid.height +=
      kBlockSize * (growth->above + BlocksBeyond(bottom(before) - bottom(needed), pixel));
  return grid;
}

// Marks the tiles of blocks.
class TileMarks {
 public:
  explicit TileMarks(MapGrowth* growth)
      : growth_(*growth),
        width_(BlocksOf(growth->grid.width)),
        height_(BlocksOf(growth->grid.height)) {
    growth->relief.is_wanted.assign(static_cast<size_t>(growth->grid.NumTiles()), 0);
  }

  // With the blocks as far as `reach` around.
  void Mark(int x, int y, int reach) {
    const int per_tile = growth_.grid.tile_size / kBlockSize;
    const int last_x = std::min(x + reach, width_ - 1) / per_tile;
    const int last_y = std::min(y + reach, height_ - 1) / per_tile;
    for (int v = std::max(y - reach, 0) / per_tile; v <= last_y; ++v) {
      for (int u = std::max(x - reach, 0) / per_tile; u <= last_x; ++u) {
        growth_.relief.is_wanted[static_cast<size_t>(v * growth_.grid.NumTilesX() + u)] = 1;
      }
    }
  }

 private:
  MapGrowth& growth_;
  int width_, height_;
};

// Calls take(x, y) for every block with a surface that a new picture may show.
template <typename Take>
void ForEachNewlySeen(const MapMemory& before, const BlockRelief& blocks, const MapGrid& grid,
                      const std::vector<MapView>& views, const Take& take) {
  const std::vector<MapView> added(
      views.begin() + static_cast<std::ptrdiff_t>(before.exposure.Gains().size()), views.end());
  const std::vector<std::array<int, 4>> footprints = FootprintBlocks(blocks, grid, added);
  for (size_t i = 0; i < added.size(); ++i) {
    for (int y = footprints[i][1]; y <= footprints[i][3]; ++y) {
      for (int x = footprints[i][0]; x <= footprints[i][2]; ++x) {
        const float height = blocks.mean[blocks.At(x, y)];
        if (std::isnan(height)) continue;
        const Eigen::Vector2d place = grid.PlaceOf((x + 0.5) * kBlockSize, (y + 0.5) * kBlockSize);
        if (added[i].PixelOf({place.x(), place.y(), double{height}})) take(x, y);
      }
    }
  }
}

BlockRelief BlocksBefore(const MapMemory& before, const MapGrowth& growth) {
  BlockRelief blocks;
  blocks.width = BlocksOf(growth.grid.width);
  blocks.height = BlocksOf(growth.grid.height);
  blocks.lowest = before.lowest;
  blocks.highest = before.highest;
  blocks.mean.assign(static_cast<size_t>(blocks.width) * static_cast<size_t>(blocks.height),
                     kNoHeight);
  for (int y = 0; y < blocks.height; ++y) {
    for (int x = 0; x < blocks.width; ++x) {
      size_t at = 0;
      if (growth.BlockBefore(before, x, y, &at)) blocks.mean[blocks.At(x, y)] = before.mean[at];
    }
  }
  return blocks;
}

}  // namespace

bool MapGrowth::BlockBefore(const MapMemory& before, int x, int y, size_t* at) const {
  const int width = BlocksOf(before.grid.width), height = BlocksOf(before.grid.height);
  if (x < left || y < above || x - left >= width || y - above >= height) return false;
  *at = static_cast<size_t>(y - above) * static_cast<size_t>(width) + static_cast<size_t>(x - left);
  return true;
}

MapGrowth GrowMap(const MapMemory& before, const MapGrid& needed,
                  const std::filesystem::path& cloud_path, const std::vector<MapView>& views) {
  MapGrowth growth;
  growth.grid = GrownGrid(before.grid, needed, &growth);
  const MapGrid& grid = growth.grid;
  TileMarks marks(&growth);
  ReadPointsFrom(cloud_path, before.num_points, [&](const Eigen::Vector3d& xyz) {
    const Eigen::Vector3d in_map = before.frame.map_from_cloud * xyz;
    const Eigen::Vector2d pixel = grid.PixelOf(in_map.x(), in_map.y());
    if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < grid.width && pixel.y() < grid.height)) {
      return;
    }
    marks.Mark(static_cast<int>(pixel.x()) / kBlockSize, static_cast<int>(pixel.y()) / kBlockSize,
               kReach);
  });
  BlockRelief blocks = BlocksBefore(before, growth);
  ForEachNewlySeen(before, blocks, grid, views, [&](int x, int y) { marks.Mark(x, y, 1); });
  growth.relief.lowest = blocks.lowest;
  growth.relief.highest = blocks.highest;
  growth.relief.mean = std::move(blocks.mean);
  return growth;
}

std::vector<int32_t> KeptSlots(const MapMemory& before, const MapGrowth& growth,
                               const Relief& relief, const std::vector<MapView>& views) {
  const BlockRelief& blocks = relief.Blocks();
  std::vector<int32_t> kept(blocks.mean.size(), -1);
  for (int y = 0; y < blocks.height; ++y) {
    for (int x = 0; x < blocks.width; ++x) {
      size_t at = 0;
      if (growth.BlockBefore(before, x, y, &at)) kept[blocks.At(x, y)] = before.sources.slot[at];
    }
  }
  ForEachNewlySeen(before, blocks, growth.grid, views,
                   [&](int x, int y) { kept[blocks.At(x, y)] = -1; });
  return kept;
}

}  // namespace colmap_seapoint
