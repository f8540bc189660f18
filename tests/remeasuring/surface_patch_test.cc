#include "colmap_seapoint/remeasuring/surface_patch.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace colmap_seapoint {
namespace {

Camera StrongLens() {
  Camera camera;
  camera.model = CameraModel::kOpenCV;
  camera.width = 600;
  camera.height = 400;
  camera.params = {500, 500, 300, 200, -0.25, 0.08, 0.001, -0.001};
  return camera;
}

// A picture's pixel in another picture, by way of a plane seen by the first.
Eigen::Vector2d Exact(const Camera& camera, const SeenPlane& plane, const Rigid3d& other,
                      const Eigen::Vector2d& pixel) {
  return *camera.ImgFromCam(other * *plane.At(*camera.CamFromImg(pixel)));
}

// From a corner of one picture to the middle of a turned one that looks from the side.
TEST(PredictPatch, IsWhereTheMeanOfThePatchIs) {
  const Camera camera = StrongLens();
  const Eigen::Vector2d middle(540.5, 360.5);
  SeenPlane plane;
  plane.through = {*camera.CamFromImg(middle), 0.5};
  plane.slope = {0.12, -0.2};
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()));
  const Rigid3d other = {turn, Eigen::Vector3d(-1, 0.4, 0.1) - turn * Eigen::Vector3d(0.2, 0, 0)};
  const auto patch = PatchOnPlane(camera, Rigid3d(), plane, middle);
  ASSERT_TRUE(patch);
  const auto predicted = PredictPatch(camera, other, *patch);
  ASSERT_TRUE(predicted);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int y = -7; y <= 7; ++y) {
    for (int x = -7; x <= 7; ++x) {
      sum += Exact(camera, plane, other, middle + Eigen::Vector2d(x, y));
    }
  }
  const Eigen::Vector2d mean = sum / 225, exact = Exact(camera, plane, other, middle);
  EXPECT_GT((mean - exact).norm(), 0.005);
  EXPECT_LT((predicted->place.pixel - mean).norm(), 0.0005);
  EXPECT_LT((predicted->place.pixel - predicted->bend - exact).norm(), 1e-6);
}

}  // namespace
}  // namespace colmap_seapoint
