#include "examples/survey/render/lens_table.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/error.h"
#include "examples/survey/paths/survey_camera.h"

namespace colmap_seapoint {
namespace {

constexpr int kLensStep = 4;  // pixels

}  // namespace

LensTable::LensTable(const Camera& camera)
    : is_fisheye_(camera.model == CameraModel::kOpenCVFisheye),
      max_tangent_(MaxTangent(camera)),
      nodes_x_(camera.width / kLensStep + 2) {
  const int nodes_y = camera.height / kLensStep + 2;
  nodes_.reserve(static_cast<size_t>(nodes_x_) * static_cast<size_t>(nodes_y));
  for (int j = 0; j < nodes_y; ++j) {
    for (int i = 0; i < nodes_x_; ++i) {
      const auto ray = camera.CamFromImg({double(i * kLensStep), double(j * kLensStep)});
      SEAPOINT_CHECK(ray.has_value() || is_fisheye_);
      if (!ray) {
        nodes_.emplace_back(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
        continue;
      }
      const double tangent = ray->norm();
      const bool by_angle = is_fisheye_ && tangent > 0;
      nodes_.push_back(by_angle ? Eigen::Vector2d(*ray * (std::atan(tangent) / tangent)) : *ray);
    }
  }
}

std::optional<Eigen::Vector3d> LensTable::Ray(double x, double y) const {
  const int i = static_cast<int>(x) / kLensStep, j = static_cast<int>(y) / kLensStep;
  const double u = x / kLensStep - i, v = y / kLensStep - j;
  const Eigen::Vector2d* top = nodes_.data() + j * nodes_x_ + i;
  const Eigen::Vector2d* bottom = top + nodes_x_;
  Eigen::Vector2d ray =
      (1 - v) * ((1 - u) * top[0] + u * top[1]) + v * ((1 - u) * bottom[0] + u * bottom[1]);
  if (!is_fisheye_) return ray.homogeneous();
  const double angle = ray.norm();
  // Not a number beside a node without a ray.
  if (!(angle < std::atan(max_tangent_))) return std::nullopt;
  if (angle > 0) ray *= std::tan(angle) / angle;
  return ray.homogeneous();
}

}  // namespace colmap_seapoint
