#include "examples/survey/visibility.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

const double kMinCosine = std::cos(80 * 3.14159265358979323846 / 180);

double MaxTangent(const Camera& camera) {
  double max = 0;
  for (double x : {0.0, 0.5, 1.0}) {
    for (double y : {0.0, 0.5, 1.0}) {
      const auto ray = camera.CamFromImg({x * camera.width, y * camera.height});
      if (ray) max = std::max(max, ray->norm());
    }
  }
  return 1.02 * max;
}

}  // namespace

SurfaceVisibility::SurfaceVisibility(const SparseModel& model, const HeightField& surface)
    : surface_(&surface) {
  for (const PosedImage& image : model.images) {
    const Camera& camera = model.cameras.at(image.camera_id);
    views_.push_back(
        {image.cam_from_world, image.cam_from_world.OriginInSource(), &camera, MaxTangent(camera)});
  }
}

std::optional<Eigen::Vector2d> SurfaceVisibility::Project(size_t image_idx,
                                                          const Eigen::Vector3d& point,
                                                          const Eigen::Vector3d& normal) const {
  const View& view = views_[image_idx];
  const Eigen::Vector3d in_cam = view.cam_from_world * point;
  if (in_cam.z() <= 0 || in_cam.head<2>().norm() > view.max_tangent * in_cam.z()) {
    return std::nullopt;
  }
  const auto pixel = view.camera->ImgFromCam(in_cam);
  if (!pixel || !view.camera->InImage(*pixel)) return std::nullopt;
  const Eigen::Vector3d to_camera = view.centre - point;
  const double distance = to_camera.norm();
  if (normal.dot(to_camera) < kMinCosine * distance) return std::nullopt;
  // Start a hundredth of a cell off the surface, so that the point does not hide itself.
  const double start = 0.01 * surface_->Grid().step / distance;
  const Eigen::Vector3d lifted = point + 0.01 * surface_->Grid().step * normal;
  if (surface_->IntersectRay(lifted, view.centre - lifted, start, 1)) return std::nullopt;
  return pixel;
}

int SurfaceVisibility::CountViews(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                  int limit) const {
  int num_views = 0;
  for (size_t i = 0; i < views_.size() && num_views < limit; ++i) {
    num_views += Project(i, point, normal).has_value();
  }
  return num_views;
}

}  // namespace colmap_seapoint
