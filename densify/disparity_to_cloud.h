// Reprojection (paper 2.6): partial disparity -> points with normals and colours, in the world.
#pragma once

#include <vector>

#include "colmap_seapoint/base/image.h"
#include "densify/coverage.h"
#include "densify/partial_cloud.h"
#include "densify/propagation.h"
#include "densify/rectification.h"

namespace colmap_seapoint {

// One point a matched sample, in raster order of the samples. Normals from the plane through the
// neighbouring points (towards the camera where there are too few); colours of picture 1.
PartialCloud MakePartialCloud(const PartialDisparity& partial, const PairGeometry& geometry,
                              const RectMap& map1, const ColorImage& color1, int num_threads);

// The mean point of every cell of which at least half is filled.
CloudFootprint MakeFootprint(const PartialDisparity& partial, const PairGeometry& geometry,
                             const std::vector<int>& cell_of_sample,
                             const std::vector<float>& filled, const CellGrid& cells);

}  // namespace colmap_seapoint
