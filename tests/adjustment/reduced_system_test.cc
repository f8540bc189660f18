// Against the dense normal equations of all poses, lenses and points.
#include "colmap_seapoint/adjustment/reduced_system.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/adjustment/dense_matrix.h"
#include "tests/mapping/exact_survey.h"

namespace colmap_seapoint {
namespace {

// Every other picture through a second, simpler lens of three held parameters.
SparseModel TwoLenses() {
  SparseModel model = ExactSurvey(ExactLens(), 3);
  Camera second = MakeCamera(CameraModel::kRadial, 880, 1000, 750);
  second.camera_id = 2;
  model.cameras[2] = second;
  for (size_t i = 0; i < model.images.size(); i += 2) model.images[i].camera_id = 2;
  return Disturbed(model);
}

TEST(ReducedSystemTest, IsTheDenseSchurComplement) {
  const std::map<uint32_t, LensFreedom> freedom = {{1, {0, true, 3}}, {2, {0b110, false, 0}}};
  const SparseModel model = TwoLenses();
  const Bundle bundle = MakeBundle(model, freedom);
  ASSERT_EQ(bundle.lenses.size(), 2u);
  BundleValues values = ReadValues(bundle, freedom, model);
  values.lenses[1][2] += 2;  // off where the prior wants it (the second lens is camera 1)
  const RobustLoss loss = {LossKind::kCauchy, 0.7};
  Linearization linearization = MakeLinearization(bundle);
  Linearize(bundle, values, loss, 1, &linearization);
  ReducedSystem system = MakeReducedSystem(bundle);
  Reduce(bundle, values, loss, linearization, 1, &system);

  const Eigen::Index size = system.gradient.size();
  const auto num_points = static_cast<Eigen::Index>(bundle.NumPoints());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(
      2 * static_cast<Eigen::Index>(bundle.NumObservations()), size + 3 * num_points);
  Eigen::VectorXd residuals(jacobian.rows());
  for (size_t k = 0; k < bundle.NumObservations(); ++k) {
    const auto row = static_cast<Eigen::Index>(2 * k);
    const ObservationEquations equations = EquationsOf(bundle, values, loss, k);
    const uint32_t picture = bundle.picture_of[k];
    residuals.segment<2>(row) = equations.residual;
    jacobian.block<2, 6>(row, kBlockSize * picture) = equations.by_pose;
    jacobian.block(row, system.LensIndex(bundle.lens_of_picture[picture]), 2,
                   equations.by_lens.cols()) = equations.by_lens;
    jacobian.block<2, 3>(row, size + 3 * bundle.point_of[k]) = equations.by_point;
  }
  Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
  Eigen::VectorXd gradient = jacobian.transpose() * residuals;
  for (Eigen::Index k = 0; k < size; ++k) {
    if (normal(k, k) == 0) normal(k, k) = 1;
  }
  size_t camera_1 = bundle.camera_id[0] == 1 ? 0 : 1;
  for (int axis = 0; axis < 2; ++axis) {
    const auto param = static_cast<size_t>(2 + axis);
    const Eigen::Index k = system.LensIndex(camera_1) + bundle.lenses[camera_1].slots[param];
    normal(k, k) += 1.0 / 9;
    gradient[k] += (values.lenses[camera_1][param] - bundle.lenses[camera_1].prior[param]) / 9;
  }
  const auto corner = normal.bottomRightCorner(3 * num_points, 3 * num_points);
  const auto side = normal.topRightCorner(size, 3 * num_points);
  const Eigen::MatrixXd through = side * corner.inverse();
  const Eigen::MatrixXd expected = normal.topLeftCorner(size, size) - through * side.transpose();
  const Eigen::VectorXd expected_gradient =
      gradient.head(size) - through * gradient.tail(3 * num_points);
  const Eigen::MatrixXd reduced = Dense(system.matrix);
  // Derivatives are kept as single precision.
  for (Eigen::Index a = 0; a < size; ++a) {
    for (Eigen::Index b = 0; b < size; ++b) {
      const double scale = std::sqrt(normal(a, a) * normal(b, b));
      ASSERT_NEAR(reduced(a, b) / scale, expected(a, b) / scale, 1e-6) << a << " " << b;
    }
    EXPECT_NEAR(system.gradient[a], expected_gradient[a], 1e-5 * gradient.norm());
  }
  // The points' steps are those of the full equations.
  const Eigen::VectorXd step = 1e-3 * Eigen::VectorXd::LinSpaced(size, -1, 1);
  const Eigen::VectorXd of_points =
      -corner.inverse() * (gradient.tail(3 * num_points) + side.transpose() * step);
  for (size_t p = 0; p < bundle.NumPoints(); ++p) {
    const Eigen::Vector3d expected_step = of_points.segment<3>(static_cast<Eigen::Index>(3 * p));
    EXPECT_LT((PointStep(bundle, linearization, system, step, p) - expected_step).norm(),
              1e-4 * expected_step.norm() + 1e-7);
  }
}

}  // namespace
}  // namespace colmap_seapoint
