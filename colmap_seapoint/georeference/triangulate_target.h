// The place in the model of a target that a person has marked in several pictures: the end of a
// scale bar, or a ground control point (ours).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/rigid3.h"

namespace colmap_seapoint {

struct TargetView {
  const Camera* camera = nullptr;
  Rigid3d cam_from_world;
  Eigen::Vector2d pixel;  // COLMAP's convention: the first pixel's centre is (0.5, 0.5)
};

struct TriangulatedTarget {
  std::string problem;                            // why it has no place; empty: it has one
  Eigen::Vector3d xyz = Eigen::Vector3d::Zero();  // model's frame
  // Covariance of xyz, model units squared, for marks with a standard deviation of 1 pixel; the
  // cameras are taken as exact.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::vector<double> errors;  // one a view, pixels; infinite where the place is behind the camera
  std::vector<bool> is_used;   // one a view: whether its error is within max_error
};

// The place that most views agree on, from the best of all pairs of rays (at least half a degree
// apart), then by least squares over the views within `max_error` pixels of it. A problem, not an
// exception, when there are fewer than two views, when no two rays meet, or when the views that
// agree are not more than those that do not. Cost: the cube of the number of views, which grows no
// more from 60 on: so many rays, evenly chosen, are paired then.
TriangulatedTarget TriangulateTarget(const std::vector<TargetView>& views, double max_error);

}  // namespace colmap_seapoint
