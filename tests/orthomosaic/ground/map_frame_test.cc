#include "colmap_seapoint/orthomosaic/ground/map_frame.h"

#include <gtest/gtest.h>

#include <random>

#include "colmap_seapoint/base/error.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Points about a plane through `center`, 10 x 4, rough by 0.1; a fifth of them anywhere.
Points PlanePoints(const Eigen::Vector3d& center, const Eigen::Vector3d& right,
                   const Eigen::Vector3d& up, double outliers) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points points;
  for (int i = 0; i < 4000; ++i) {
    const bool is_outlier = uniform(random) > 1 - 2 * outliers;
    const double along = uniform(random), across = uniform(random), off = uniform(random);
    points.push_back(center + 5 * along * right + 2 * across * up +
                     (is_outlier ? 20 : 0.1) * off * right.cross(up));
  }
  return points;
}

// Cameras 3 above (0, 0, depth) that look along +z, the world's "down", turned about it.
SparseModel CamerasAbove(const std::vector<double>& turns_deg) {
  SparseModel model;
  model.cameras[1] = MakeCamera(CameraModel::kPinhole, 100, 200, 100);
  for (const double turn : turns_deg) {
    PosedImage image;
    image.camera_id = 1;
    image.cam_from_world =
        StandAt(model.cameras[1], {0.1 * turn, 0, 0}, {0, 0, turn}).cam_from_world;
    model.images.push_back(image);
  }
  return model;
}

Eigen::Vector3d AxisOf(const MapFrame& frame, int axis) {
  return frame.map_from_cloud.rotation.conjugate() * Eigen::Vector3d::Unit(axis);
}

ModelUnits Metric(const std::string& frame) {
  ModelUnits units;
  units.is_metric = true;
  units.frame = frame;
  return units;
}

TEST(MapFrame, PlaneIsThatOfMostPointsSeenFromTheCameras) {
  const Points points =
      PlanePoints({1, 2, 3}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), 0.2);
  const MapFrame frame = FindMapFrame({}, CamerasAbove({0, 180, 0, 180}), points, std::nullopt);
  EXPECT_EQ(frame.kind, PlaneKind::kFitted);
  EXPECT_FALSE(frame.is_north_up);
  EXPECT_LT((AxisOf(frame, 2) + Eigen::Vector3d::UnitZ()).norm(), 0.01);  // cameras are at z = 0
  // The pictures do not agree on what is upright: the longest side lies to the right.
  EXPECT_GT(std::abs(AxisOf(frame, 0).x()), 0.999);
  EXPECT_NEAR((frame.map_from_cloud * Eigen::Vector3d(1, 2, 3)).norm(), 0, 0.2);
  EXPECT_NEAR(AxisOf(frame, 0).cross(AxisOf(frame, 1)).dot(AxisOf(frame, 2)), 1, 1e-9);
}

TEST(MapFrame, IsTurnedAsThePicturesAreWhereTheyAgree) {
  const Points points =
      PlanePoints({0, 0, 3}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), 0);
  const MapFrame frame = FindMapFrame({}, CamerasAbove({85, 90, 95}), points, std::nullopt);
  // Turned by 90 degrees about their axis, their upper side points to -x or +x, across the extent.
  EXPECT_GT(std::abs(AxisOf(frame, 1).x()), 0.99);
}

TEST(MapFrame, ALevelModelKeepsItsOwnAxesExactly) {
  const Points points =
      PlanePoints({5, 5, -9}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), 0);
  for (const char* name : {"local", "east-north-up", "projected"}) {
    const MapFrame frame = FindMapFrame({}, CamerasAbove({0}), points, Metric(name));
    EXPECT_EQ(frame.kind, PlaneKind::kLevel);
    EXPECT_EQ(frame.is_north_up, name != std::string("local"));
    EXPECT_EQ(frame.map_from_cloud * points[7], points[7]);
  }
  EXPECT_EQ(FindMapFrame({}, CamerasAbove({0}), points, Metric("model")).kind, PlaneKind::kFitted);
}

TEST(MapFrame, AWallInALevelModelIsSeenAcrossWithUpUp) {
  // In the plane x = 4; the cameras stand at x = 0.
  const Points points =
      PlanePoints({4, 0, 0}, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 0.1);
  const MapFrame frame = FindMapFrame({}, CamerasAbove({0, 1}), points, Metric("east-north-up"));
  EXPECT_EQ(frame.kind, PlaneKind::kWall);
  EXPECT_NE(frame.text.find("wall"), std::string::npos);
  EXPECT_LT((AxisOf(frame, 2) + Eigen::Vector3d::UnitX()).norm(), 0.02);
  EXPECT_GT(AxisOf(frame, 1).z(), 0.999);
  MapFrameOptions options;
  options.plane = MapPlane::kModel;
  EXPECT_EQ(FindMapFrame(options, CamerasAbove({0}), points, Metric("east-north-up")).kind,
            PlaneKind::kLevel);
}

TEST(MapFrame, GivenDirectionsDecide) {
  const Points points =
      PlanePoints({0, 0, 3}, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), 0);
  MapFrameOptions options;
  options.towards_eye = Eigen::Vector3d(0, -2, 0);
  options.up = Eigen::Vector3d(0, -1, -5);
  const MapFrame frame = FindMapFrame(options, CamerasAbove({0}), points, std::nullopt);
  EXPECT_EQ(frame.kind, PlaneKind::kGiven);
  EXPECT_NEAR((AxisOf(frame, 2) + Eigen::Vector3d::UnitY()).norm(), 0, 1e-12);
  EXPECT_NEAR((AxisOf(frame, 1) + Eigen::Vector3d::UnitZ()).norm(), 0, 1e-12);
}

TEST(MapFrame, ImpossibleDirectionsAreRefused) {
  const Points points = {{0, 0, 3}};
  MapFrameOptions options;
  options.towards_eye = Eigen::Vector3d(0, 0, 0);
  EXPECT_THROW(FindMapFrame(options, CamerasAbove({0}), points, std::nullopt), Error);
  options.towards_eye = Eigen::Vector3d(0, 1, std::nan(""));
  EXPECT_THROW(FindMapFrame(options, CamerasAbove({0}), points, std::nullopt), Error);
  options.towards_eye = Eigen::Vector3d(0, 1, 1);
  options.up = Eigen::Vector3d(0, -3, -3);
  EXPECT_THROW(FindMapFrame(options, CamerasAbove({0}), points, std::nullopt), Error);
}

TEST(MapFrame, OnePointOrALineIsNoReasonToFail) {
  for (const Points& points : {Points{{1, 2, 3}}, Points{{0, 0, 3}, {1, 0, 3}, {2, 0, 3}}}) {
    const MapFrame frame = FindMapFrame({}, CamerasAbove({0, 180}), points, std::nullopt);
    EXPECT_TRUE((frame.map_from_cloud * points[0]).allFinite());
    EXPECT_NEAR(frame.map_from_cloud.rotation.norm(), 1, 1e-9);
  }
}

}  // namespace
}  // namespace colmap_seapoint
