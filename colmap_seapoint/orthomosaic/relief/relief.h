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

// Squares of kBlockSize pixels: pictures are chosen by them.
struct BlockRelief {
  int width = 0, height = 0;      // blocks
  std::vector<float> mean;        // height of the surface; kNoHeight where there is none
  float lowest = 0, highest = 0;  // over all blocks' surfaces

  size_t At(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
  bool Contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};

class Relief {
 public:
  // Makes all tiles, on `num_threads`; they lie in a temporary file in `folder`. Throws Error when
  // that cannot be written, or no cell of the map has a surface.
  Relief(const CloudTiles& cloud, const MapGrid& grid, bool fill, int num_threads,
         const std::filesystem::path& folder);

  // Empty() where there is no surface. From any thread.
  ReliefTile Read(int tile_idx) const;
  bool HasSurface(int tile_idx) const { return store_.NumRecords(tile_idx) > 0; }
  const BlockRelief& Blocks() const { return blocks_; }
  const MapGrid& Grid() const { return grid_; }
  // How far a height may be off, beside what noise does: a cell's side, in the map's unit.
  double CellSide() const { return cell_side_; }

 private:
  void Keep(int tile_idx, const ReliefTile& tile);
  void AddBlocks(const MapGrid::Box& box, const ReliefTile& tile);

  MapGrid grid_;
  TileStore store_;
  BlockRelief blocks_;
  double cell_side_ = 0;
};

}  // namespace colmap_seapoint
