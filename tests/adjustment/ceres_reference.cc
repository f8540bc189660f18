#include "tests/adjustment/ceres_reference.h"

#include <ceres/ceres.h>

#include "colmap_seapoint/base/camera_projection.h"

namespace colmap_seapoint {
namespace {

struct Residual {
  Eigen::Vector2d pixel;
  double weight;

  template <typename T>
  bool operator()(const T* rotation, const T* translation, const T* xyz, const T* params,
                  T* residual) const {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Eigen::Quaternion<T>> cam_from_world(rotation);
    const Vector3 in_cam =
        cam_from_world * Eigen::Map<const Vector3>(xyz) + Eigen::Map<const Vector3>(translation);
    const auto d = DistortedDirection(CameraModel::kOpenCV, params, in_cam);
    residual[0] = weight * (params[0] * d.x() + params[2] - pixel.x());
    residual[1] = weight * (params[1] * d.y() + params[3] - pixel.y());
    return true;
  }
};

}  // namespace

double AdjustByCeres(double scale, SparseModel* model) {
  ceres::Problem problem;
  double* params = model->cameras.begin()->second.params.data();
  for (PosedImage& image : model->images) {
    Rigid3d& pose = image.cam_from_world;
    for (size_t k = 0; k < image.points2D.size(); ++k) {
      SparsePoint& point = model->points3D.at(image.point3D_ids[k]);
      if (point.track.size() < 2) continue;
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 2, 4, 3, 3, 8>(
                                   new Residual{image.points2D[k], 1 / scale}),
                               new ceres::SoftLOneLoss(1), pose.rotation.coeffs().data(),
                               pose.translation.data(), point.xyz.data(), params);
    }
    problem.SetManifold(pose.rotation.coeffs().data(), new ceres::EigenQuaternionManifold);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.final_cost;
}

}  // namespace colmap_seapoint
