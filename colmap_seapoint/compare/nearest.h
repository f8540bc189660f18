// Exact distances to the nearest point of a cloud that lies in tiles.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "colmap_seapoint/compare/point_tiles.h"

namespace colmap_seapoint {

inline constexpr double kBeyond = std::numeric_limits<double>::infinity();

enum class NearestOf { kAnyPoint, kOtherPlace };  // kOtherPlace: points at distance 0 are no answer

// A k-d tree in memory (nanoflann): about 40 bytes a point, 0.4 s to build a million. Keeps a
// reference to the points; they must outlive it. Squares are summed x, y, z in double precision.
class PointIndex {
 public:
  // With kOtherPlace no place may stand twice in `points`.
  explicit PointIndex(const PointVector& points);
  ~PointIndex();
  // Lowers *squared to that of the nearest point when one is nearer than that.
  void Nearest(const Eigen::Vector3d& place, NearestOf what, double* squared) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// For each of `queries`, which lie in `tile`: the squared distance to the nearest point of `cloud`,
// kBeyond when that is farther than `max_distance` (itself included). Memory: the points of one
// tile, and their index. Tiles are taken up the nearest first, and only those points of them that
// can be the nearest of a query.
std::vector<double> NearestSquared(const PointTiles& cloud, int tile, const PointVector& queries,
                                   double max_distance, NearestOf what);

}  // namespace colmap_seapoint
