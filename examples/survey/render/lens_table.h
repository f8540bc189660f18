// The inverse of a lens and its port, fast.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "examples/survey/paths/survey_port.h"

namespace colmap_seapoint {

// Rays in the camera frame by pixel: the exact inverse of lens and port on a 4-pixel lattice,
// bilinear between, on the plane z = 1 or (fisheye) on that of the angles (better than 0.002 px).
class LensTable {
 public:
  explicit LensTable(const PortCamera& camera);
  // nullopt where the lens forms no picture (MaxTangent): the corners of a wide fisheye.
  std::optional<WaterRay> Ray(double x, double y) const;

 private:
  bool is_fisheye_ = false;
  double max_tangent_ = 0;
  int nodes_x_ = 0;
  std::vector<Eigen::Vector2d> nodes_;
  std::vector<Eigen::Vector3d> origins_;  // empty without a port
};

}  // namespace colmap_seapoint
