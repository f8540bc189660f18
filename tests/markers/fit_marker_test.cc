#include "colmap_seapoint/markers/fit_marker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/markers/marker_world.h"

namespace colmap_seapoint {
namespace {

constexpr double kWidth = 25;  // of a marker, pixels

// A picture as a camera hands it over, of one that holds linear light.
GrayImage InSrgb(GrayImage picture) {
  for (uint8_t& value : picture.data) {
    const double v = value / 255.0;
    const double s = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
    value = static_cast<uint8_t>(std::lround(255 * s));
  }
  return picture;
}

double SideOf(const std::array<Eigen::Vector2d, 4>& corners) {
  double sum = 0;
  for (size_t k = 0; k < 4; ++k) sum += (corners[k] - corners[(k + 1) % 4]).norm();
  return sum / 4;
}

struct Errors {
  int num_found = 0;
  double side = 0;    // mean relative error
  double centre = 0;  // the largest one, pixels

  void Add(const DetectedMarker& marker, const Eigen::Vector2d& true_centre) {
    ++num_found;
    side += (SideOf(marker.corners) / kWidth - 1) / kNumMarkers;
    centre = std::max(centre, (marker.Centre() - true_centre).norm());
  }

  static constexpr int kNumMarkers = 6;
};

// Markers of several numbers and turns, seen from straight above, one a picture. None lies along
// the rows: the picture's few rays would move its edges.
Errors Measure(const Water& water, bool in_srgb) {
  const Camera camera = MakeCamera(CameraModel::kPinhole, 500, 100, 80);
  Errors errors;
  for (int id = 0; id < Errors::kNumMarkers; ++id) {
    const PlaneMarker marker = {{MarkerFamily::kTag36h11, 3 * id},
                                {0.011 * id - 0.03, 0.007 * id - 0.02, 2},
                                0.1,
                                0.3 + 0.47 * id};
    GrayImage picture = MarkerPicture({marker}, camera, Rigid3d(), water);
    if (in_srgb) picture = InSrgb(picture);
    for (const DetectedMarker& found : DetectMarkers(picture, {MarkerFamily::kTag36h11})) {
      errors.Add(found, *camera.ImgFromCam(marker.centre));
    }
  }
  return errors;
}

// The library's corners leave these sides 0.1 to 3.2 % wrong, and centres up to 0.36 pixels.
TEST(FitCornersTest, SidesAreRightInLinearLightAndAsCamerasGiveIt) {
  for (const bool in_srgb : {false, true}) {
    for (const int blur : {0, 1, 3}) {
      const Errors errors = Measure({1, 0, blur, 0.2}, in_srgb);
      EXPECT_EQ(errors.num_found, Errors::kNumMarkers);
      EXPECT_LT(std::abs(errors.side), 0.002) << in_srgb << " " << blur;
      EXPECT_LT(errors.centre, 0.08) << in_srgb << " " << blur;
    }
  }
}

TEST(FitCornersTest, WhatIsNotLikeThePrintStaysAsItIs) {
  const PlaneMarker marker = {{MarkerFamily::kTag36h11, 3}, {0, 0, 2}, 0.1, 0.3};
  const Camera camera = MakeCamera(CameraModel::kPinhole, 500, 100, 80);
  const GrayImage picture = MarkerPicture({marker}, camera, Rigid3d());
  auto found = DetectMarkers(picture, {MarkerFamily::kTag36h11});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(FitCorners(picture, found[0]));
  found[0].name.id = 4;
  EXPECT_FALSE(FitCorners(picture, found[0]));
  found[0].name.id = 3;
  EXPECT_FALSE(FitCorners(GrayImage(100, 80, 1, 128), found[0]));
  EXPECT_FALSE(FitCorners(GrayImage(), found[0]));
  found[0].corners.fill({50, 40});
  EXPECT_FALSE(FitCorners(picture, found[0]));
  found[0].corners.fill({std::nan(""), 1e300});
  EXPECT_FALSE(FitCorners(picture, found[0]));
}

}  // namespace
}  // namespace colmap_seapoint
