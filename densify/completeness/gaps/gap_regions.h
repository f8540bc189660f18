// Cells that are missing, as areas that a person can go back to.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "densify/completeness/surface/asked_area.h"
#include "densify/completeness/surface/ground.h"

namespace colmap_seapoint {

struct GapRegion {
  LayerKey layer;
  GapCause cause = GapCause::kNone;
  std::vector<std::pair<int, int>> cells;  // x, y; row by row
  double area = 0;                         // units^2, along the surface
  // Along the cells' sides, in the layer's plan, units: outer boundaries counter-clockwise, those
  // of holes clockwise, each behind the outer one that it lies in.
  std::vector<Ring> rings;
};

// Where a square of `min_cells` x `min_cells` cells fits into what is missing; single covered cells
// within count as missing there. Cells of one cause that touch are one region; slivers of another
// cause along a region belong to it. Regions below `min_area` (units^2) are left out. In the order
// of layers and rows.
std::vector<GapRegion> FindGapRegions(int min_cells, double min_area, Ground* ground);

// The boundary of a set of cells of side 1, sorted by row: see GapRegion::rings.
std::vector<Ring> TraceCells(const std::vector<std::pair<int, int>>& cells);

}  // namespace colmap_seapoint
