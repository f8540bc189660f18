// A rigid motion b_from_a: x_b = rotation * x_a + translation.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace colmap_seapoint {

struct Rigid3d {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return rotation * x + translation; }

  // c_from_a = c_from_b * b_from_a
  Rigid3d operator*(const Rigid3d& b_from_a) const {
    return {(rotation * b_from_a.rotation).normalized(),
            rotation * b_from_a.translation + translation};
  }

  Rigid3d Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }

  // The origin of frame b seen in frame a: the camera centre, when this is cam_from_world.
  Eigen::Vector3d OriginInSource() const { return -(rotation.conjugate() * translation); }
};

}  // namespace colmap_seapoint
