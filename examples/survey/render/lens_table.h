// The inverse of a lens, fast.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/camera.h"

namespace colmap_seapoint {

// Directions in the camera frame by pixel: the exact inverse of the lens on a 4-pixel lattice,
// bilinear between, on the plane z = 1 or (fisheye) on that of the angles (better than 0.002 px).
class LensTable {
 public:
  explicit LensTable(const Camera& camera);
  // z = 1. nullopt where the lens forms no picture (MaxTangent): the corners of a wide fisheye.
  std::optional<Eigen::Vector3d> Ray(double x, double y) const;

 private:
  bool is_fisheye_ = false;
  double max_tangent_ = 0;
  int nodes_x_ = 0;
  std::vector<Eigen::Vector2d> nodes_;
};

}  // namespace colmap_seapoint
