#include "colmap_seapoint/adjustment/equations/lens_jacobian.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

LensParams ParamsOf(const Camera& camera) {
  LensParams params{};
  std::copy(camera.params.begin(), camera.params.end(), params.begin());
  return params;
}

// Central differences, of a step that suits the size of x.
template <typename Function>
Eigen::Vector2d Numeric(double* x, const Function& function) {
  const double was = *x, step = 1e-6 * std::max(1.0, std::abs(was));
  *x = was + step;
  const Eigen::Vector2d after = function();
  *x = was - step;
  const Eigen::Vector2d before = function();
  *x = was;
  return (after - before) / (2 * step);
}

TEST(LensJacobianTest, AllModelsAgreeWithDifferences) {
  for (CameraModel model : RectifiableCameraModels()) {
    const Camera camera = MildCamera(model, 900, 1000, 750);
    LensParams params = ParamsOf(camera);
    for (Eigen::Vector3d point : {Eigen::Vector3d(0.5, -0.4, 1.7), Eigen::Vector3d(-0.1, 0.9, 2),
                                  Eigen::Vector3d(1e-3, 2e-3, 1.5)}) {
      const auto project = [&] { return ProjectThroughLens(model, params, point); };
      EXPECT_LT((project() - *camera.ImgFromCam(point)).norm(), 1e-9);
      const LensJacobian jacobian = DifferentiateLens(model, params, point);
      EXPECT_EQ(jacobian.pixel, project());
      for (int k = 0; k < 3; ++k) {
        EXPECT_LT((jacobian.by_point.col(k) - Numeric(&point[k], project)).norm(), 2e-5)
            << static_cast<int>(model) << " " << k;
      }
      for (size_t k = 0; k < camera.params.size(); ++k) {
        const Eigen::Vector2d numeric = Numeric(&params[k], project);
        EXPECT_LT((jacobian.by_params.col(static_cast<int>(k)) - numeric).norm(),
                  2e-5 + 1e-6 * numeric.norm())
            << static_cast<int>(model) << " " << k;
      }
      EXPECT_LT((DifferentiateByPoint(model, params, point).by_point - jacobian.by_point).norm(),
                1e-9);
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
