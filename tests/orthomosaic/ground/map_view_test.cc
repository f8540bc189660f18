#include "colmap_seapoint/orthomosaic/ground/map_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

// A camera at (0, 0, 2) of the map, which looks down but for `tilt_deg` about its x axis.
MapView ViewFromAbove(const Camera& camera, double tilt_deg) {
  const Viewpoint viewpoint = StandAt(camera, {0, 0, 2}, {180 + tilt_deg, 0, 0});
  return MapView(camera, viewpoint.cam_from_world);
}

TEST(MapView, GsdIsHeightOverFocalLength) {
  const Camera camera = MakeCamera(CameraModel::kPinhole, 400, 320, 240);
  const MapView view = ViewFromAbove(camera, 0);
  EXPECT_NEAR(view.GsdAt({0.1, 0.1, 0}), 0.005, 1e-12);
  const MapView higher(camera, StandAt(camera, {0, 0, 4}, {180, 0, 0}).cam_from_world);
  const auto gsd = SurveyGsd({higher, view}, {{0, 0, 0}, {0.1, 0, 0}, {50, 0, 0}});
  ASSERT_TRUE(gsd.has_value());
  EXPECT_NEAR(*gsd, 0.005, 1e-12);
  EXPECT_FALSE(SurveyGsd({view}, {{50, 0, 0}, {0, 0, 3}}).has_value());
  EXPECT_FALSE(SurveyGsd({}, {{0, 0, 0}}).has_value());
}

TEST(MapView, FootprintHoldsAllThatIsSeen) {
  for (const double tilt : {0.0, 25.0, 60.0}) {
    for (const CameraModel model : {CameraModel::kOpenCV, CameraModel::kOpenCVFisheye}) {
      const MapView view = ViewFromAbove(MildCamera(model, 200, 320, 240), tilt);
      const auto footprint = view.Footprint(-0.5, 0.5, 40);
      ASSERT_TRUE(footprint.has_value());
      int num_seen = 0;
      for (double x = -20; x < 20; x += 0.25) {
        for (double y = -20; y < 20; y += 0.25) {
          for (const double z : {-0.5, 0.5}) {
            if (!view.PixelOf({x, y, z})) continue;
            ++num_seen;
            EXPECT_TRUE(x >= (*footprint)[0] - 0.1 && x <= (*footprint)[2] + 0.1) << tilt;
            EXPECT_TRUE(y >= (*footprint)[1] - 0.1 && y <= (*footprint)[3] + 0.1) << tilt;
          }
        }
      }
      EXPECT_GT(num_seen, 50);
    }
  }
}

TEST(MapView, WhatTheLensFoldsBackIsNotSeen) {
  Camera camera = MakeCamera(CameraModel::kSimpleRadial, 200, 320, 240);
  camera.params[3] = -0.15;
  const MapView view = ViewFromAbove(camera, 0);
  // Far to the side, where r (1 - 0.15 r^2) has come back to the middle of the picture.
  const Eigen::Vector3d aside(2 * 2.5, 0, 0);
  ASSERT_TRUE(camera.InImage(*camera.ImgFromCam({2.5, 0, 1})));
  EXPECT_FALSE(view.PixelOf(aside).has_value());
  EXPECT_TRUE(view.PixelOf({0.2, 0.2, 0}).has_value());
  EXPECT_FALSE(view.PixelOf({0, 0, 3}).has_value());  // behind
  EXPECT_FALSE(view.PixelOf({std::nan(""), 0, 0}).has_value());
}

}  // namespace
}  // namespace colmap_seapoint
