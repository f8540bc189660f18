#include "colmap_seapoint/mapping/initial_pair.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinInliers = 100;         // COLMAP's
constexpr double kMaxForwardMotion = 0.95;  // COLMAP's: share of the way that led straight ahead
constexpr double kGoodAngleDeg = 8;         // COLMAP's first look asks for 16, its second for 8
constexpr double kMinAngleDeg = 0.5;
constexpr double kDegrees = 180 / M_PI;

class PairAngles {
 public:
  explicit PairAngles(const ColmapDatabase& database)
      : database_(database), cameras_(ReadCameras(database)) {
    for (const DatabaseImage& image : ReadImages(database)) {
      camera_ids_[image.image_id] = image.camera_id;
    }
  }

  // The median angle between the rays of the inliers; 0 where there are none.
  double Median(const ImagePair& pair, const TwoViewGeometry& geometry) {
    const std::vector<Eigen::Vector3d>& rays1 = RaysOf(pair.first);
    const std::vector<Eigen::Vector3d>& rays2 = RaysOf(pair.second);
    std::vector<double> angles;
    for (const FeatureMatch& match : geometry.inliers) {
      if (match.idx1 >= rays1.size() || match.idx2 >= rays2.size()) continue;
      const Eigen::Vector3d turned = geometry.cam2_from_cam1->rotation * rays1[match.idx1];
      const double angle =
          std::atan2(turned.cross(rays2[match.idx2]).norm(), turned.dot(rays2[match.idx2]));
      if (std::isfinite(angle)) angles.push_back(kDegrees * angle);
    }
    if (angles.empty()) return 0;
    const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
    std::nth_element(angles.begin(), middle, angles.end());
    return *middle;
  }

 private:
  // Not finite where a pixel has no ray; none without SeaPoints or a camera.
  const std::vector<Eigen::Vector3d>& RaysOf(uint32_t image_id) {
    const auto [entry, is_new] = rays_.try_emplace(image_id);
    const auto camera = cameras_.find(camera_ids_[image_id]);
    const auto features = is_new ? ReadFeatures(database_, image_id) : std::nullopt;
    if (!features || camera == cameras_.end()) return entry->second;
    for (const SeaPoint& point : features->points) {
      const auto ray = camera->second.CamFromImg({point.x, point.y});
      entry->second.push_back(ray ? ray->homogeneous()
                                  : Eigen::Vector3d::Constant(std::nan("")).eval());
    }
    return entry->second;
  }

  const ColmapDatabase& database_;
  std::map<uint32_t, Camera> cameras_;
  std::map<uint32_t, uint32_t> camera_ids_;
  std::map<uint32_t, std::vector<Eigen::Vector3d>> rays_;
};

bool CanBegin(const TwoViewGeometry& geometry) {
  if (geometry.inliers.size() < kMinInliers || !geometry.cam2_from_cam1) return false;
  // The pose of a plane or of a mere turn is one of several, and COLMAP may find another.
  if (geometry.config == TwoViewConfig::kPlanarOrPanoramic) return false;
  return std::abs(geometry.cam2_from_cam1->translation.z()) < kMaxForwardMotion;
}

}  // namespace

std::optional<InitialPair> FindInitialPair(const ColmapDatabase& database) {
  PairAngles angles(database);
  std::optional<InitialPair> best;
  for (const ImagePair& pair : ReadVerifiedPairs(database)) {
    const TwoViewGeometry geometry = ReadTwoViewGeometry(database, pair);
    if (!CanBegin(geometry)) continue;
    const double angle_deg = angles.Median(pair, geometry);
    if (angle_deg >= kGoodAngleDeg) return std::nullopt;
    if (angle_deg < (best ? best->angle_deg : kMinAngleDeg)) continue;
    best = {pair.first, pair.second, geometry.inliers.size(), angle_deg};
  }
  return best;
}

std::optional<MapperOptions> OptionsOfInitialPair(const ColmapProgram& colmap,
                                                  const MapperOptions& first_round,
                                                  const InitialPair& pair) {
  // COLMAP measures the angle after an estimate of its own, which differs somewhat.
  const MapperOptions to_begin = {
      {"Mapper.init_image_id1", std::to_string(pair.image_id1)},
      {"Mapper.init_image_id2", std::to_string(pair.image_id2)},
      {"Mapper.init_min_tri_angle", std::to_string(pair.angle_deg / 2)},
      {"Mapper.init_min_num_inliers", std::to_string(kMinInliers / 2)},
      {"Mapper.multiple_models", "0"}};  // the second one would begin with the same pair
  MapperOptions options = first_round;
  for (const auto& [name, value] : to_begin) {
    if (!colmap.HasMapperOption(name) || !options.emplace(name, value).second) return std::nullopt;
  }
  return options;
}

}  // namespace colmap_seapoint
