// The surface around a picture's points, as planes through them and their neighbours.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace colmap_seapoint {

// A point of the camera's frame as it is seen, x / z and y / z, and its inverse depth: on a plane
// the one is a linear function of the other.
struct SeenPoint {
  Eigen::Vector2d direction;
  double inverse_depth;
};

struct SeenPlane {
  SeenPoint through;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  // of the inverse depth; 0: facing the camera

  // The plane's point in that direction; nullopt where it is not in front of the camera.
  std::optional<Eigen::Vector3d> At(const Eigen::Vector2d& direction) const;
};

// One plane through each of `wanted` (positions in `points`) and as well as possible through its
// twelve nearest neighbours; what lies off, such as points of another surface, hardly counts.
// Facing the camera where a point has too few neighbours, or would be seen at less than 15 degrees.
std::vector<SeenPlane> FitPlanes(const std::vector<SeenPoint>& points,
                                 const std::vector<size_t>& wanted);

}  // namespace colmap_seapoint
