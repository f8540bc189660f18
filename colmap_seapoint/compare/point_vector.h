#pragma once

#include <Eigen/Core>
#include <vector>

namespace colmap_seapoint {

using PointVector = std::vector<Eigen::Vector3d>;  // units of the clouds

}  // namespace colmap_seapoint
