// Exact distances to the nearest point of a cloud that lies in tiles.
#pragma once

#include <vector>

#include "colmap_seapoint/compare/point_index.h"
#include "colmap_seapoint/compare/point_tiles.h"

namespace colmap_seapoint {

// For each of `queries`, which lie in `tile`: the squared distance to the nearest point of `cloud`,
// kBeyond when that is more than `max_distance`. The tiles are read one after the other, the
// nearest first, and of each only the points are kept that can be the nearest of a query. Memory:
// the points of one tile, and their index.
std::vector<double> NearestSquared(const PointTiles& cloud, int tile, const PointVector& queries,
                                   double max_distance, NearestOf what);

}  // namespace colmap_seapoint
