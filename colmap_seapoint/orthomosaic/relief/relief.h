// The surface of a whole map: finely by tiles on the disk, coarsely in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "colmap_seapoint/io/cloud/tile_store.h"
#include "colmap_seapoint/orthomosaic/ground/map_grid.h"
#include "colmap_seapoint/orthomosaic/relief/cloud_tiles.h"
#include "colmap_seapoint/orthomosaic/relief/relief_tile.h"

namespace colmap_seapoint {

inline constexpr int kBlockSize = 16;  // pixels; tiles are whole blocks

inline constexpr int kRegionBlocks = 8;  // along each side of a region

// Squares of kBlockSize pixels: pictures are chosen by them.
struct BlockRelief {
  int width = 0, height = 0;      // blocks
  std::vector<float> mean;        // height of the surface; kNoHeight where there is none
  float lowest = 0, highest = 0;  // over all blocks' surfaces
  // Of every region and the eight around it the highest mean; FindTops() makes it of `mean`.
  std::vector<float> region_tops;

  void FindTops();
  // No block's mean within kRegionBlocks blocks is higher.
  float HighestAround(int x, int y) const {
    return region_tops[static_cast<size_t>(y / kRegionBlocks) * RegionsX() +
                       static_cast<size_t>(x / kRegionBlocks)];
  }
  size_t RegionsX() const {
    return static_cast<size_t>((width + kRegionBlocks - 1) / kRegionBlocks);
  }

  size_t At(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
  bool Contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};

// Of a map that is continued: which tiles are made, and what is known of the others.
struct KnownRelief {
  std::vector<uint8_t> is_wanted;  // by tile
  std::vector<float> mean;         // by block, as BlockRelief
  float lowest = 0, highest = 0;
};

class Relief {
 public:
  // Makes all tiles, or all that are wanted, on `num_threads`; they lie in a temporary file in
  // `folder`. Throws Error when that cannot be written, NoMap when no cell of the map has a
  // surface.
  Relief(const CloudTiles& cloud, const MapGrid& grid, bool fill, int num_threads,
         const std::filesystem::path& folder, const KnownRelief* known = nullptr);

  // Empty() where there is no surface. From any thread.
  ReliefTile Read(int tile_idx) const;
  bool HasSurface(int tile_idx) const { return store_.NumRecords(tile_idx) > 0; }
  const BlockRelief& Blocks() const { return blocks_; }
  const MapGrid& Grid() const { return grid_; }
  // A cell's side, in the map's unit: the relief is no finer.
  double CellSide(int tile_idx) const;

 private:
  void Keep(int tile_idx, const ReliefTile& tile);
  void TakeOver(const KnownRelief& known);
  void AddBlocks(const MapGrid::Box& box, const ReliefTile& tile);

  MapGrid grid_;
  TileStore store_;
  BlockRelief blocks_;
  std::vector<int> cell_sizes_;  // by tile, pixels
};

}  // namespace colmap_seapoint
