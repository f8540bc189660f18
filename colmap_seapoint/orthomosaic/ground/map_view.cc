#include "colmap_seapoint/orthomosaic/ground/map_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr int kSamples = 16;     // of the picture along each side
constexpr double kSlack = 1.02;  // of the field of view, beyond the samples of its border

}  // namespace

MapView::MapView(const Camera& camera, const Rigid3d& cam_from_map)
    : camera_(camera),
      rotation_(cam_from_map.rotation.toRotationMatrix()),
      translation_(cam_from_map.translation),
      center_(cam_from_map.OriginInSource()) {
  for (int i = 0; i <= kSamples; ++i) {
    for (int j = 0; j <= kSamples; ++j) {
      const Eigen::Vector2d pixel(camera.width * i / double{kSamples},
                                  camera.height * j / double{kSamples});
      const auto ray = camera.CamFromImg(pixel);
      if (!ray) continue;
      border_.push_back(ray->homogeneous());
      max_tan2_ = std::max(max_tan2_, kSlack * kSlack * ray->squaredNorm());
    }
  }
}

std::optional<std::array<double, 4>> MapView::Footprint(double low, double high,
                                                        double max_reach) const {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Eigen::Array2d least(kInf, kInf), most(-kInf, -kInf);
  for (const Eigen::Vector3d& ray : border_) {
    const Eigen::Vector3d direction = (rotation_.transpose() * ray).normalized();
    for (const double height : {low, high}) {
      const double t = (height - center_.z()) / direction.z();
      const bool meets = t > 0 && t < max_reach;
      // What looks past the horizon, or begins between the heights, sees as far as it reaches.
      const Eigen::Array2d place = (center_ + (meets                      ? t
                                               : (t > 0 || height == low) ? max_reach
                                                                          : 0.0) *
                                                  direction)
                                       .head<2>()
                                       .array();
      least = least.min(place);
      most = most.max(place);
    }
  }
  if (!(least <= most).all()) return std::nullopt;
  return std::array<double, 4>{least.x(), least.y(), most.x(), most.y()};
}

std::vector<MapView> MakeMapViews(const SparseModel& model, const Rigid3d& map_from_cloud) {
  const Rigid3d cloud_from_map = map_from_cloud.Inverse();
  std::vector<MapView> views;
  views.reserve(model.images.size());
  for (const PosedImage& image : model.images) {
    views.emplace_back(model.cameras.at(image.camera_id), image.cam_from_world * cloud_from_map);
  }
  return views;
}

std::optional<double> SurveyGsd(const std::vector<MapView>& views,
                                const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> best;
  for (const Eigen::Vector3d& point : points) {
    double least = std::numeric_limits<double>::infinity();
    for (const MapView& view : views) {
      if (view.PixelOf(point)) least = std::min(least, view.GsdAt(point));
    }
    if (std::isfinite(least)) best.push_back(least);
  }
  if (best.empty() || 2 * best.size() < points.size()) return std::nullopt;
  return UpperMedian(std::move(best));
}

}  // namespace colmap_seapoint
