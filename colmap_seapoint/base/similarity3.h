// A similarity b_from_a: x_b = scale * rotation * x_a + translation. What turns a model of
// arbitrary units into one in metres.
#pragma once

#include "colmap_seapoint/base/rigid3.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

struct Similarity3d {
  double scale = 1;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const {
    return scale * (rotation * x) + translation;
  }

  Similarity3d Inverse() const {
    Similarity3d inverse;
    inverse.scale = 1 / scale;
    inverse.rotation = rotation.conjugate();
    inverse.translation = -inverse.scale * (inverse.rotation * translation);
    return inverse;
  }
};

// The same camera (or rig) in the new world, whose unit is also that of the new camera frame.
inline Rigid3d TransformedPose(const Rigid3d& cam_from_old, const Similarity3d& new_from_old) {
  Rigid3d cam_from_new;
  cam_from_new.rotation = (cam_from_old.rotation * new_from_old.rotation.conjugate()).normalized();
  cam_from_new.translation = new_from_old.scale * cam_from_old.translation -
                             cam_from_new.rotation * new_from_old.translation;
  return cam_from_new;
}

// Poses and points; pixels and reprojection errors stay as they are.
inline void TransformModel(const Similarity3d& new_from_old, SparseModel* model) {
  for (PosedImage& image : model->images) {
    image.cam_from_world = TransformedPose(image.cam_from_world, new_from_old);
  }
  for (auto& [id, point] : model->points3D) point.xyz = new_from_old * point.xyz;
}

}  // namespace colmap_seapoint
