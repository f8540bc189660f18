#include "colmap_seapoint/adjustment/equations/lens_jacobian.h"

#include <algorithm>

#include "colmap_seapoint/adjustment/equations/dual.h"
#include "colmap_seapoint/base/camera_projection.h"

namespace colmap_seapoint {
namespace {

// d(u / z, v / z) / d(x, y, z), where (u, v) is the point on the plane z = 1.
Eigen::Matrix<double, 2, 3> PerspectiveJacobian(double u, double v, double z) {
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << 1 / z, 0, -u / z,  //
      0, 1 / z, -v / z;
  return jacobian;
}

template <int kNumDistortion>
LensJacobian Differentiate(CameraModel model, const LensParams& params,
                           const Eigen::Vector3d& point) {
  using Number = Dual<2 + kNumDistortion>;
  const int num_focals = NumFocals(model);
  const int first = num_focals + 2;
  std::array<Number, kMaxLensParams> numbers;
  std::copy(params.begin(), params.end(), numbers.begin());
  for (int k = 0; k < kNumDistortion; ++k) numbers[static_cast<size_t>(first + k)].by[2 + k] = 1;
  const double u = point.x() / point.z(), v = point.y() / point.z();
  const Eigen::Matrix<Number, 3, 1> direction(Number::Variable(u, 0), Number::Variable(v, 1),
                                              Number(1));
  const Eigen::Matrix<Number, 2, 1> d = DistortedDirection(model, numbers.data(), direction);

  LensJacobian jacobian;
  const Eigen::Vector2d focals(params[0], params[static_cast<size_t>(num_focals - 1)]);
  Eigen::Matrix2d by_direction;
  jacobian.by_params.template leftCols<4>().setZero();
  for (int axis = 0; axis < 2; ++axis) {
    const int principal = num_focals + axis;
    jacobian.pixel[axis] = focals[axis] * d[axis].value + params[static_cast<size_t>(principal)];
    by_direction.row(axis) = focals[axis] * d[axis].by.template head<2>().transpose();
    jacobian.by_params(axis, principal) = 1;
    jacobian.by_params(axis, num_focals == 1 ? 0 : axis) = d[axis].value;
    for (int k = 0; k < kNumDistortion; ++k) {
      jacobian.by_params(axis, first + k) = focals[axis] * d[axis].by[2 + k];
    }
  }
  jacobian.by_point = by_direction * PerspectiveJacobian(u, v, point.z());
  return jacobian;
}

}  // namespace

int NumFocals(CameraModel model) {
  return FindCameraModel(static_cast<int>(model))->has_single_focal ? 1 : 2;
}

Eigen::Vector2d ProjectThroughLens(CameraModel model, const LensParams& params,
                                   const Eigen::Vector3d& point) {
  const auto num_focals = static_cast<size_t>(NumFocals(model));
  const Eigen::Vector2d d = DistortedDirection(model, params.data(), point);
  return {params[0] * d.x() + params[num_focals],
          params[num_focals - 1] * d.y() + params[num_focals + 1]};
}

LensJacobian DifferentiateLens(CameraModel model, const LensParams& params,
                               const Eigen::Vector3d& point) {
  const CameraModelInfo& info = *FindCameraModel(static_cast<int>(model));
  switch (info.num_params - NumFocals(model) - 2) {
    case 0:
      return Differentiate<0>(model, params, point);
    case 1:
      return Differentiate<1>(model, params, point);
    case 2:
      return Differentiate<2>(model, params, point);
    case 4:
      return Differentiate<4>(model, params, point);
    case 8:
      return Differentiate<8>(model, params, point);
    default:
      return Differentiate<12>(model, params, point);
  }
}

LensJacobian DifferentiateByPoint(CameraModel model, const LensParams& params,
                                  const Eigen::Vector3d& point) {
  return Differentiate<0>(model, params, point);
}

}  // namespace colmap_seapoint
