#include "colmap_seapoint/compare/point_tiles.h"

#include <algorithm>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"

namespace colmap_seapoint {
namespace {

constexpr int64_t kProgressPoints = 1 << 16;

}  // namespace

CloudSurvey SurveyCloud(const std::filesystem::path& path, uint64_t stride,
                        const CountCallback& progress) {
  CloudReader reader(path);
  CloudSurvey survey;
  survey.fits_float = reader.FitsFloat();
  int64_t num_read = 0;
  for (CloudVertex vertex; reader.Next(&vertex); ++num_read) {
    survey.farthest = std::max(survey.farthest, vertex.xyz.cwiseAbs().maxCoeff());
    if (num_read % static_cast<int64_t>(stride) == 0) {
      survey.sample.push_back(vertex.xyz);
      if (vertex.normal.allFinite()) survey.normal_sum += vertex.normal.cast<double>();
    }
    if (num_read % kProgressPoints == 0) progress(num_read);
  }
  survey.num_points = static_cast<uint64_t>(num_read);
  if (num_read == 0) {
    throw Error(path.string(), "holds no points", "give a cloud with at least one");
  }
  return survey;
}

PointTiles::PointTiles(const std::filesystem::path& cloud, bool fits_float,
                       const std::filesystem::path& temporary_folder, const PlanView& view,
                       const TilePartition& partition, const CountCallback& progress)
    : fits_float_(fits_float),
      view_(view),
      partition_(partition),
      store_(temporary_folder, partition.NumTiles(),
             3 * (fits_float ? sizeof(float) : sizeof(double))) {
  CloudReader reader(cloud);
  int64_t num_read = 0;
  for (CloudVertex vertex; reader.Next(&vertex); ++num_read) {
    const int tile = partition_.TileOf(PlanOf(vertex.xyz));
    if (fits_float_) {
      const Eigen::Vector3f xyz = vertex.xyz.cast<float>();
      store_.Append(tile, xyz.data());
    } else {
      store_.Append(tile, vertex.xyz.data());
    }
    if (num_read % kProgressPoints == 0) progress(num_read);
  }
  store_.Finish();
}

PointVector PointTiles::Read(int tile) const {
  PointVector points;
  if (fits_float_) {
    for (const auto& xyz : store_.Read<std::array<float, 3>>(tile)) {
      points.emplace_back(xyz[0], xyz[1], xyz[2]);
    }
  } else {
    for (const auto& xyz : store_.Read<std::array<double, 3>>(tile)) {
      points.emplace_back(xyz[0], xyz[1], xyz[2]);
    }
  }
  return points;
}

}  // namespace colmap_seapoint
