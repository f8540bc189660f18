// Measures over cells of space and of the plan, tile by tile: what a tile holds whole is summed up,
// what reaches over its border is kept until the others have told their part.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/compare/cell_map.h"
#include "colmap_seapoint/compare/cloud_comparison.h"
#include "colmap_seapoint/compare/point_tiles.h"

namespace colmap_seapoint {

struct CellCounts {
  uint32_t num_points = 0;
  std::array<uint32_t, kMaxDistances> num_within = {};
};

// Over cells that are complete.
struct CellSums {
  uint64_t num_cells = 0;
  std::array<double, kMaxDistances> shares = {};  // sum over the cells of num_within / num_points

  void Add(const CellCounts& counts, size_t num_distances);
  void Add(const CellSums& other);
};

// One grid of cells, over one tile or over all.
struct CellLayer {
  CellSums whole;
  CellMap<CellCounts> at_border;

  void Merge(const CellLayer& tile);
  CellSums Finish(size_t num_distances) const;  // with what was at the borders
};

// Grids of one way: ETH3D's two, the plan's for areas, the plan's for redundancy.
struct CellLayers {
  enum Layer { kVoxels, kShiftedVoxels, kArea, kRedundancy, kNumLayers };
  std::array<CellLayer, kNumLayers> layers;

  void Merge(const CellLayers& tile);
};

// `squared`: of `points`, which are all those of the tile.
CellLayers MeasureCells(const PointTiles& cloud, int tile, const PointVector& points,
                        const std::vector<double>& squared, const CloudComparison& setup);

// Sets the cell measures of `way`.
void FinishCells(const CellLayers& cells, const CloudComparison& setup, OneWay* way);

}  // namespace colmap_seapoint
