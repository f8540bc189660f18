// Where a lens puts a point of the camera frame, and how that moves with the point and with the
// lens's parameters. Only the distortion is differentiated by dual numbers: the rest (perspective,
// focal lengths, principal point) has derivatives that one can write down.
#pragma once

#include <Eigen/Core>
#include <array>

#include "colmap_seapoint/base/camera.h"

namespace colmap_seapoint {

inline constexpr int kMaxLensParams = 16;
using LensParams = std::array<double, kMaxLensParams>;  // COLMAP's order; unused ones are 0

// 1 or 2; the principal point's two parameters follow.
int NumFocals(CameraModel model);

struct LensJacobian {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point;
  // Columns of parameters that the model has not are not set.
  Eigen::Matrix<double, 2, kMaxLensParams> by_params;
};

// Of a point with z > 0 in the camera frame; any model but kEquirectangular. Not finite where the
// lens's formula is not.
Eigen::Vector2d ProjectThroughLens(CameraModel model, const LensParams& params,
                                   const Eigen::Vector3d& point);
LensJacobian DifferentiateLens(CameraModel model, const LensParams& params,
                               const Eigen::Vector3d& point);
// The same without the parameters (`by_params` is of no use), in a third of the time.
LensJacobian DifferentiateByPoint(CameraModel model, const LensParams& params,
                                  const Eigen::Vector3d& point);

}  // namespace colmap_seapoint
