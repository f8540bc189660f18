// The nearest of many points, exactly.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "colmap_seapoint/compare/point_vector.h"

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
  // Positions in `points` of the `count` points nearest to the place, the nearest first; of fewer
  // when there are fewer.
  std::vector<uint32_t> NearestPositions(const Eigen::Vector3d& place, size_t count) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace colmap_seapoint
