// Reprojection (paper 2.6): partial surface -> points with normals and colours, in the world.
#pragma once

#include <vector>

#include "colmap_seapoint/base/picture.h"
#include "densify/cloud/partial_cloud.h"
#include "densify/match/cell_grid.h"
#include "densify/match/rectification.h"
#include "densify/match/surface_fit.h"
#include "densify/overlap/coverage.h"

namespace colmap_seapoint {

// One point a sample of the surface, in raster order of the samples; normals from its slopes
// (towards the camera where it has none), colours of picture 1.
PartialCloud MakePartialCloud(const PartialSurface& surface, const PairGeometry& geometry,
                              const RectMap& map1, const Picture& picture1, int num_threads);

// What the surface fills of picture 1's cells.
struct CellTally {
  std::vector<float> filled;  // share of each cell's samples that hold surface, 0..1
  CloudFootprint footprint;   // mean point of every new cell that is covered (kMinCoveredCell)
};

// cell_of_node: the cell that each of the nodes lies in, -1 outside the picture. The footprint
// leaves out the cells that are known already.
CellTally TallyCells(const PartialSurface& surface, const PairGeometry& geometry,
                     const SampleGrid& nodes, const std::vector<int>& cell_of_node,
                     const KnownCells& known);

}  // namespace colmap_seapoint
