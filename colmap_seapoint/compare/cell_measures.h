// Measures over cells of space and of the plan, tile by tile. A cell that lies in one tile is
// summed up at once; one that reaches over a border is kept until the tiles beyond have added their
// points.
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

// Sums over the cells whose points are all counted.
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
  CellSums Finish(size_t num_distances) const;  // the cells at the borders included
};

// The grids of one way: two for ETH3D's measure, and two of the plan, for areas and for redundancy.
struct CellLayers {
  enum Layer { kVoxels, kShiftedVoxels, kArea, kRedundancy, kNumLayers };
  std::array<CellLayer, kNumLayers> layers;

  void Merge(const CellLayers& tile);
};

// `points` are all those of the tile; `squared` are their squared distances to the other cloud.
CellLayers MeasureCells(const PointTiles& cloud, int tile, const PointVector& points,
                        const std::vector<double>& squared, const CloudComparison& setup);

// Sets the measures of `way` that are made over cells.
void FinishCells(const CellLayers& cells, const CloudComparison& setup, OneWay* way);

}  // namespace colmap_seapoint
