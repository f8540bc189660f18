#include "feature/matching/two_view_verification.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

enum class Shape { kRelief, kPlane };

struct Scene {
  Viewpoint view1, view2;
  std::vector<SeaPoint> points1, points2;
  FeatureMatches matches;
  std::vector<bool> is_outlier;
};

SeaPoint At(double x, double y) {
  SeaPoint point;
  point.x = static_cast<float>(x);
  point.y = static_cast<float>(y);
  return point;
}

// Exact projections (to float) of points on a seabed 3 m below, with 2 m of relief or none; a share
// of the second picture's points lies anywhere.
Scene MakeScene(const Camera& camera, Shape shape, size_t count, double outlier_share,
                unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Scene scene;
  scene.view1 = StandAt(camera, {-0.3, 0, 0}, {2, -1, 3});
  scene.view2 = StandAt(camera, {0.4, 0.1, -0.1}, {-3, 4, -8});
  const Eigen::Quaterniond into_world = scene.view1.cam_from_world.rotation.conjugate();
  while (scene.matches.size() < count) {
    const Eigen::Vector2d pixel1(unit(generator) * camera.width, unit(generator) * camera.height);
    const Eigen::Vector3d ray = into_world * camera.CamFromImg(pixel1)->homogeneous();
    const double z = shape == Shape::kPlane ? 3 : 2 + 2 * unit(generator);
    const Eigen::Vector3d point = scene.view1.Center() + z / ray.z() * ray;
    const auto pixel2 = camera.ImgFromCam(scene.view2.cam_from_world * point);
    if (!pixel2 || !camera.InImage(*pixel2)) continue;
    const bool outlier = unit(generator) < outlier_share;
    const uint32_t idx = static_cast<uint32_t>(scene.matches.size());
    scene.points1.push_back(At(pixel1.x(), pixel1.y()));
    scene.points2.push_back(
        outlier ? At(unit(generator) * camera.width, unit(generator) * camera.height)
                : At(pixel2->x(), pixel2->y()));
    scene.matches.push_back({idx, idx});
    scene.is_outlier.push_back(outlier);
  }
  return scene;
}

TwoViewGeometry Verify(const Scene& scene, const TwoViewVerificationOptions& options = {}) {
  return VerifyTwoViews(scene.view1.camera, scene.points1, scene.view2.camera, scene.points2,
                        scene.matches, options);
}

Camera PriorCamera(bool prior) {
  Camera camera = MildCamera(CameraModel::kPinhole, 900, 1360, 1024);
  camera.has_prior_focal_length = prior;
  return camera;
}

void ExpectPose(const Scene& scene, const TwoViewGeometry& geometry) {
  ASSERT_TRUE(geometry.cam2_from_cam1);
  const Rigid3d truth = scene.view2.cam_from_world * scene.view1.cam_from_world.Inverse();
  const double angle = truth.rotation.angularDistance(geometry.cam2_from_cam1->rotation);
  EXPECT_LT(angle * 180 / M_PI, 0.1);
  EXPECT_NEAR(geometry.cam2_from_cam1->translation.norm(), 1, 1e-9);
  const double cosine =
      truth.translation.normalized().dot(geometry.cam2_from_cam1->translation.normalized());
  EXPECT_LT(std::acos(std::min(1.0, cosine)) * 180 / M_PI, 0.5);
}

// All true matches are among the inliers, hardly any other.
void ExpectInliers(const Scene& scene, const TwoViewGeometry& geometry, double max_false_share) {
  size_t num_true = 0, num_false = 0;
  for (const FeatureMatch& match : geometry.inliers) {
    ++(scene.is_outlier[match.idx1] ? num_false : num_true);
  }
  size_t num_all_true = 0;
  for (const bool outlier : scene.is_outlier) num_all_true += !outlier;
  EXPECT_GE(static_cast<double>(num_true), 0.99 * static_cast<double>(num_all_true));
  EXPECT_LE(static_cast<double>(num_false), max_false_share * static_cast<double>(num_all_true));
}

// Distance of the true matches from their epipolar lines in picture 2, pixels.
double WorstEpipolarDistance(const Scene& scene, const Eigen::Matrix3d& fundamental) {
  double worst = 0;
  for (const FeatureMatch& match : scene.matches) {
    if (scene.is_outlier[match.idx1]) continue;
    const SeaPoint &a = scene.points1[match.idx1], &b = scene.points2[match.idx2];
    const Eigen::Vector3d line = fundamental * Eigen::Vector3d(a.x, a.y, 1);
    worst =
        std::max(worst, std::abs(line.dot(Eigen::Vector3d(b.x, b.y, 1))) / line.head<2>().norm());
  }
  return worst;
}

Eigen::Matrix3d Calibration(const Camera& camera) {
  Eigen::Matrix3d k;
  k << camera.FocalX(), 0, camera.PrincipalX(), 0, camera.FocalY(), camera.PrincipalY(), 0, 0, 1;
  return k;
}

TEST(TwoViewVerificationTest, CalibratedRelief) {
  const Scene scene = MakeScene(PriorCamera(true), Shape::kRelief, 400, 0.3, 1);
  const TwoViewGeometry geometry = Verify(scene);
  EXPECT_EQ(geometry.config, TwoViewConfig::kCalibrated);
  ExpectInliers(scene, geometry, 0.05);
  ExpectPose(scene, geometry);
  ASSERT_TRUE(geometry.E);
  const Eigen::Matrix3d inverse = Calibration(scene.view1.camera).inverse();
  EXPECT_LT(WorstEpipolarDistance(scene, inverse.transpose() * *geometry.E * inverse), 0.3);
}

TEST(TwoViewVerificationTest, UncalibratedRelief) {
  const Scene scene = MakeScene(PriorCamera(false), Shape::kRelief, 400, 0.3, 2);
  const TwoViewGeometry geometry = Verify(scene);
  EXPECT_EQ(geometry.config, TwoViewConfig::kUncalibrated);
  ExpectInliers(scene, geometry, 0.05);
  ASSERT_TRUE(geometry.F);
  EXPECT_LT(WorstEpipolarDistance(scene, *geometry.F), 0.5);
  ExpectPose(scene, geometry);
}

TEST(TwoViewVerificationTest, DistortedLensIsNoObstacle) {
  for (const CameraModel model : {CameraModel::kOpenCV, CameraModel::kOpenCVFisheye}) {
    Camera camera = MildCamera(model, 700, 1360, 1024);
    camera.has_prior_focal_length = true;
    const Scene scene = MakeScene(camera, Shape::kRelief, 400, 0.3, 3);
    const TwoViewGeometry geometry = Verify(scene);
    EXPECT_EQ(geometry.config, TwoViewConfig::kCalibrated);
    ExpectPose(scene, geometry);
  }
}

TEST(TwoViewVerificationTest, PlaneIsPlanar) {
  for (const bool prior : {true, false}) {
    const Scene scene = MakeScene(PriorCamera(prior), Shape::kPlane, 400, 0.3, 4);
    const TwoViewGeometry geometry = Verify(scene);
    EXPECT_EQ(geometry.config, TwoViewConfig::kPlanarOrPanoramic);
    ExpectInliers(scene, geometry, 0.05);
    ASSERT_TRUE(geometry.H);
    for (const FeatureMatch& match : scene.matches) {
      if (scene.is_outlier[match.idx1]) continue;
      const SeaPoint &a = scene.points1[match.idx1], &b = scene.points2[match.idx2];
      const Eigen::Vector2d moved =
          Eigen::Vector3d(*geometry.H * Eigen::Vector3d(a.x, a.y, 1)).hnormalized();
      EXPECT_LT((moved - Eigen::Vector2d(b.x, b.y)).norm(), 0.5);
    }
  }
}

TEST(TwoViewVerificationTest, TooFewMatchesAreDegenerate) {
  const Scene few = MakeScene(PriorCamera(true), Shape::kRelief, 14, 0, 5);
  EXPECT_EQ(Verify(few).config, TwoViewConfig::kDegenerate);
  EXPECT_TRUE(Verify(few).inliers.empty());
  const Scene none = MakeScene(PriorCamera(true), Shape::kRelief, 0, 0, 5);
  EXPECT_EQ(Verify(none).config, TwoViewConfig::kDegenerate);
  TwoViewVerificationOptions options;
  options.min_num_inliers = 14;
  EXPECT_EQ(Verify(few, options).config, TwoViewConfig::kCalibrated);
}

TEST(TwoViewVerificationTest, ChanceMatchesAreDegenerate) {
  const Scene scene = MakeScene(PriorCamera(true), Shape::kRelief, 40, 1, 6);
  EXPECT_EQ(Verify(scene).config, TwoViewConfig::kDegenerate);
  EXPECT_TRUE(Verify(scene).inliers.empty());
}

TEST(TwoViewVerificationTest, DegenerateLayoutsDoNotThrow) {
  Scene line = MakeScene(PriorCamera(true), Shape::kRelief, 60, 0, 7);
  for (size_t i = 0; i < line.points1.size(); ++i) {
    line.points1[i] = At(10.0 * static_cast<double>(i), 300);
    line.points2[i] = At(10.0 * static_cast<double>(i) + 40, 300);
  }
  EXPECT_NO_THROW(Verify(line));
  for (SeaPoint& point : line.points1) point = At(500, 500);
  for (SeaPoint& point : line.points2) point = At(600, 500);
  EXPECT_NO_THROW(Verify(line));
}

TEST(TwoViewVerificationTest, SameResultEveryTime) {
  for (const bool prior : {true, false}) {
    const Scene scene = MakeScene(PriorCamera(prior), Shape::kRelief, 300, 0.4, 8);
    const TwoViewGeometry a = Verify(scene);
    Verify(MakeScene(PriorCamera(prior), Shape::kPlane, 100, 0.2, 9));
    const TwoViewGeometry b = Verify(scene);
    EXPECT_EQ(a.inliers, b.inliers);
    ASSERT_TRUE(a.cam2_from_cam1 && b.cam2_from_cam1);
    EXPECT_EQ(a.cam2_from_cam1->rotation.coeffs(), b.cam2_from_cam1->rotation.coeffs());
    EXPECT_EQ(a.cam2_from_cam1->translation, b.cam2_from_cam1->translation);
    EXPECT_EQ(a.F.has_value(), !prior);
    EXPECT_TRUE(a.F == b.F);
  }
}

}  // namespace
}  // namespace colmap_seapoint
