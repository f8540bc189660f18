// Clouds reduced to one point a voxel, as Tanks and Temples compares them.
#pragma once

#include <cstdint>

#include "colmap_seapoint/compare/point_tiles.h"

namespace colmap_seapoint {

struct ReducedShares {
  uint64_t num_input = 0, num_input_within = 0;
  uint64_t num_reference = 0, num_reference_within = 0;
};

// Of the voxels (side distance / 2) whose centres lie in `tile`: how many there are, and how many
// of their points are nearer than `distance` to the other cloud's. A voxel reaches over the border
// of its tile, and what it is near to lies beyond: the surroundings are read as well. Memory: the
// occupied voxels of the tile with a margin of 2.5 distances.
ReducedShares MeasureReduced(const PointTiles& input, const PointTiles& reference, int tile,
                             double distance);

}  // namespace colmap_seapoint
