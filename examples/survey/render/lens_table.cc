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

LensTable::LensTable(const PortCamera& camera)
    : is_fisheye_(camera.InWater().model == CameraModel::kOpenCVFisheye),
      max_tangent_(MaxTangent(camera.InWater())),
      nodes_x_(camera.InWater().width / kLensStep + 2) {
  const int nodes_y = camera.InWater().height / kLensStep + 2;
  nodes_.reserve(static_cast<size_t>(nodes_x_) * static_cast<size_t>(nodes_y));
  for (int j = 0; j < nodes_y; ++j) {
    for (int i = 0; i < nodes_x_; ++i) {
      const auto ray = camera.Ray({double(i * kLensStep), double(j * kLensStep)});
      SEAPOINT_CHECK(ray.has_value() || is_fisheye_);
      if (camera.HasPort()) origins_.push_back(ray ? ray->origin : Eigen::Vector3d::Zero());
      if (!ray) {
        nodes_.emplace_back(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
        continue;
      }
      const Eigen::Vector2d on_plane = ray->direction.head<2>();
      const double tangent = on_plane.norm();
      const bool by_angle = is_fisheye_ && tangent > 0;
      nodes_.push_back(by_angle ? Eigen::Vector2d(on_plane * (std::atan(tangent) / tangent))
                                : on_plane);
    }
  }
}

std::optional<WaterRay> LensTable::Ray(double x, double y) const {
  const int i = static_cast<int>(x) / kLensStep, j = static_cast<int>(y) / kLensStep;
  const double u = x / kLensStep - i, v = y / kLensStep - j;
  const auto between = [&](const auto* top) {
    const auto* bottom = top + nodes_x_;
    return ((1 - v) * ((1 - u) * top[0] + u * top[1]) + v * ((1 - u) * bottom[0] + u * bottom[1]))
        .eval();
  };
  const int node = j * nodes_x_ + i;
  Eigen::Vector2d ray = between(nodes_.data() + node);
  WaterRay result;
  if (!origins_.empty()) result.origin = between(origins_.data() + node);
  if (is_fisheye_) {
    const double angle = ray.norm();
    // Not a number beside a node without a ray.
    if (!(angle < std::atan(max_tangent_))) return std::nullopt;
    if (angle > 0) ray *= std::tan(angle) / angle;
  }
  result.direction = ray.homogeneous();
  return result;
}

}  // namespace colmap_seapoint
