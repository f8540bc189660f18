#include "colmap_seapoint/compare/reduced_cloud.h"

#include <array>
#include <cmath>

#include "colmap_seapoint/compare/cell_map.h"
#include "colmap_seapoint/compare/point_index.h"

namespace colmap_seapoint {
namespace {

// How far around a tile points are needed. The mean of a voxel lies within 0.87 voxels of its
// centre, the mean that it is near to within one distance of that, and the points that make up the
// latter within 1.74 voxels: with voxels of half a distance, 2.31 distances in all.
constexpr double kMargin = 2.5;  // distances
constexpr double kFixedPoint = 4294967296.0;

// Offsets from the voxel's corner in units of 2^-32 of its side: a sum of integers is the same in
// any order.
struct VoxelSum {
  uint64_t num_points = 0;
  std::array<int64_t, 3> offset = {};
};

struct ReducedCloud {
  PointVector own;  // of voxels whose centres lie in the tile
  PointVector all;
};

void AddPoint(const Eigen::Vector3d& xyz, double side, CellMap<VoxelSum>* voxels) {
  CellKey key;
  std::array<int64_t, 3> offset;
  for (size_t i = 0; i < 3; ++i) {
    const double at = xyz[static_cast<Eigen::Index>(i)] / side;
    const double corner = std::floor(at);
    key[i] = static_cast<int64_t>(corner);
    offset[i] = std::llround((at - corner) * kFixedPoint);
  }
  VoxelSum& voxel = (*voxels)[key];
  ++voxel.num_points;
  for (size_t i = 0; i < 3; ++i) voxel.offset[i] += offset[i];
}

ReducedCloud Reduce(const PointTiles& cloud, int tile, double distance) {
  const double side = 0.5 * distance, margin = kMargin * distance;
  const TilePartition& partition = cloud.Partition();
  CellMap<VoxelSum> voxels;
  for (const Eigen::Vector3d& xyz : cloud.Read(tile)) AddPoint(xyz, side, &voxels);
  for (const int other : partition.Neighbours(tile, margin)) {
    for (const Eigen::Vector3d& xyz : cloud.Read(other)) {
      if (partition.Box(tile).Distance(cloud.PlanOf(xyz)) <= margin) AddPoint(xyz, side, &voxels);
    }
  }
  ReducedCloud reduced;
  for (const auto& [key, voxel] : voxels.Items()) {
    Eigen::Vector3d center, mean;
    for (size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      const double corner = static_cast<double>(key[i]);
      center[axis] = side * (corner + 0.5);
      mean[axis] = side * (corner + static_cast<double>(voxel.offset[i]) /
                                        (kFixedPoint * static_cast<double>(voxel.num_points)));
    }
    reduced.all.push_back(mean);
    if (partition.TileOf(cloud.PlanOf(center)) == tile) reduced.own.push_back(mean);
  }
  return reduced;
}

uint64_t NumNearer(const PointVector& points, const PointVector& others, double distance) {
  const PointIndex index(others);
  const double limit = distance * distance;
  uint64_t num_nearer = 0;
  for (const Eigen::Vector3d& xyz : points) {
    double squared = limit;
    index.Nearest(xyz, NearestOf::kAnyPoint, &squared);
    num_nearer += squared < limit;
  }
  return num_nearer;
}

}  // namespace

ReducedShares MeasureReduced(const PointTiles& input, const PointTiles& reference, int tile,
                             double distance) {
  const ReducedCloud a = Reduce(input, tile, distance), b = Reduce(reference, tile, distance);
  ReducedShares shares;
  shares.num_input = a.own.size();
  shares.num_input_within = NumNearer(a.own, b.all, distance);
  shares.num_reference = b.own.size();
  shares.num_reference_within = NumNearer(b.own, a.all, distance);
  return shares;
}

}  // namespace colmap_seapoint
