// The pose of one picture from points whose places are known.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/rigid3.h"

namespace colmap_seapoint {

struct SeenPlace {
  Eigen::Vector2d pixel;
  Eigen::Vector3d xyz;  // world
};

// Those whose reprojection error is at most `max_error`, pixels.
int CountInliers(const Camera& camera, const Rigid3d& cam_from_world,
                 const std::vector<SeenPlace>& places, double max_error);

// By RANSAC over minimal samples, refined with its inliers. nullopt with fewer than six places
// whose pixel has a ray, or where no pose is found. The same result every time.
std::optional<Rigid3d> FindAbsolutePose(const Camera& camera, const std::vector<SeenPlace>& places,
                                        double max_error);

}  // namespace colmap_seapoint
