#include "examples/survey/visibility.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "examples/survey/paths/survey_camera.h"

namespace colmap_seapoint {
namespace {

constexpr double kRadPerDeg = 3.14159265358979323846 / 180;
const double kMinCosine = std::cos(80 * kRadPerDeg);
const double kParallaxCosine = std::cos(kMinParallaxDeg * kRadPerDeg);

}  // namespace

SurfaceVisibility::SurfaceVisibility(const SurveyTruth& truth)
    : surface_(&truth.surface), max_range_(truth.max_range) {
  for (const auto& [id, camera] : truth.model.cameras) cameras_.try_emplace(id, truth.port, camera);
  for (const PosedImage& image : truth.model.images) {
    views_.push_back({image.cam_from_world, image.cam_from_world.OriginInSource(),
                      &cameras_.at(image.camera_id)});
  }
}

std::optional<Eigen::Vector2d> SurfaceVisibility::InFrame(const View& view,
                                                          const Eigen::Vector3d& point) const {
  const auto pixel = view.camera->ImgFromCam(view.cam_from_world * point);
  if (!pixel || !view.camera->InWater().InImage(*pixel)) return std::nullopt;
  if ((view.centre - point).norm() > max_range_) return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector2d> SurfaceVisibility::Project(size_t image_idx,
                                                          const Eigen::Vector3d& point,
                                                          const Eigen::Vector3d& normal) const {
  const View& view = views_[image_idx];
  const auto pixel = InFrame(view, point);
  if (!pixel) return std::nullopt;
  const Eigen::Vector3d to_camera = view.centre - point;
  const double distance = to_camera.norm();
  if (normal.dot(to_camera) < kMinCosine * distance) return std::nullopt;
  // Start a hundredth of a cell off the surface, so that the point does not hide itself.
  const double start = 0.01 * surface_->CellSize() / distance;
  const Eigen::Vector3d lifted = point + 0.01 * surface_->CellSize() * normal;
  if (surface_->IntersectRay(lifted, view.centre - lifted, start, 1)) return std::nullopt;
  return pixel;
}

Sighting SurfaceVisibility::SightingIn(const View& view, const Eigen::Vector3d& point) const {
  return {GsdAt(view.camera->InWater(), view.cam_from_world * point),
          (view.centre - point).normalized()};
}

std::vector<size_t> SurfaceVisibility::PicturesAround(
    const std::vector<Eigen::Vector3d>& points) const {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : points) box.extend(point);
  std::vector<size_t> pictures;
  if (points.empty()) return pictures;
  const double radius = 0.5 * box.diagonal().norm();
  for (size_t i = 0; i < views_.size(); ++i) {
    if (!views_[i].camera->MayHold(views_[i].cam_from_world * box.center(), radius)) continue;
    if ((views_[i].centre - box.center()).norm() <= max_range_ + radius) pictures.push_back(i);
  }
  return pictures;
}

std::vector<Sighting> SurfaceVisibility::Sightings(const Eigen::Vector3d& point,
                                                   const Eigen::Vector3d& normal,
                                                   const std::vector<size_t>& pictures) const {
  std::vector<Sighting> sightings;
  for (const size_t i : pictures) {
    if (Project(i, point, normal)) sightings.push_back(SightingIn(views_[i], point));
  }
  return sightings;
}

std::vector<Sighting> SurfaceVisibility::InFrames(const Eigen::Vector3d& point,
                                                  const std::vector<size_t>& pictures) const {
  std::vector<Sighting> sightings;
  for (const size_t i : pictures) {
    if (InFrame(views_[i], point)) sightings.push_back(SightingIn(views_[i], point));
  }
  return sightings;
}

std::optional<double> BestPairGsd(std::vector<Sighting> sightings) {
  std::sort(sightings.begin(), sightings.end(),
            [](const Sighting& a, const Sighting& b) { return a.gsd < b.gsd; });
  for (size_t k = 1; k < sightings.size(); ++k) {
    for (size_t m = 0; m < k; ++m) {
      if (sightings[m].to_camera.dot(sightings[k].to_camera) <= kParallaxCosine) {
        return sightings[k].gsd;
      }
    }
  }
  return std::nullopt;
}

}  // namespace colmap_seapoint
