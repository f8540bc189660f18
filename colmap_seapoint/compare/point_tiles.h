// A cloud of any size, read twice from its file: once to know it, once to sort it into tiles.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "colmap_seapoint/compare/plan_view.h"
#include "colmap_seapoint/compare/point_vector.h"
#include "colmap_seapoint/compare/tile_partition.h"
#include "colmap_seapoint/io/cloud/tile_store.h"

namespace colmap_seapoint {

using CountCallback = std::function<void(int64_t num_points)>;  // called every now and then

struct CloudSurvey {
  uint64_t num_points = 0;
  bool fits_float = false;
  PointVector sample;  // every stride-th point
  Eigen::Vector3d normal_sum = Eigen::Vector3d::Zero();
  double farthest = 0;  // largest coordinate of any point, without its sign
};

// Reads every point once. Throws as CloudReader does, and Error for a cloud without points.
CloudSurvey SurveyCloud(const std::filesystem::path& path, uint64_t stride,
                        const CountCallback& progress);

// The points of a cloud in the tiles of the plan, bit for bit as the file holds them, in the order
// of the file. They lie in a temporary file; memory does not grow with the cloud.
class PointTiles {
 public:
  // `view` and `partition` must outlive it.
  PointTiles(const std::filesystem::path& cloud, bool fits_float,
             const std::filesystem::path& temporary_folder, const PlanView& view,
             const TilePartition& partition, const CountCallback& progress);

  uint64_t NumPoints(int tile) const { return store_.NumRecords(tile); }
  bool FitsFloat() const { return fits_float_; }
  PointVector Read(int tile) const;

  const PlanView& View() const { return view_; }
  const TilePartition& Partition() const { return partition_; }
  Eigen::Array2d PlanOf(const Eigen::Vector3d& xyz) const {
    return view_.FromWorld(xyz).head<2>().array();
  }

 private:
  bool fits_float_;
  const PlanView& view_;
  const TilePartition& partition_;
  TileStore store_;
};

}  // namespace colmap_seapoint
