#include "colmap_seapoint/markers/fit_marker.h"

#include <gtest/gtest.h>

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
  double detected = 0, fitted = 0;  // mean relative errors of the sides
  double worst_corner = 0;          // pixels
};

// Markers of several numbers and turns, seen from straight above, one a picture.
Errors Measure(const Water& water, bool in_srgb, bool is_mirrored = false) {
  const Camera camera = MakeCamera(CameraModel::kPinhole, 500, 120, 90);
  Errors errors;
  for (int id = 0; id < 10; ++id) {
    const PlaneMarker marker = {{MarkerFamily::kTag36h11, 3 * id},
                                {0.011 * id - 0.05, 0.007 * id - 0.03, 2},
                                0.1,
                                0.37 * id,
                                is_mirrored};
    GrayImage picture = MarkerPicture({marker}, camera, Rigid3d(), water);
    if (in_srgb) picture = InSrgb(picture);
    for (const DetectedMarker& found : DetectMarkers(picture, {MarkerFamily::kTag36h11})) {
      const auto fitted = FitCorners(picture, found);
      if (!fitted) continue;
      ++errors.num_found;
      errors.detected += SideOf(found.corners) / kWidth - 1;
      errors.fitted += SideOf(*fitted) / kWidth - 1;
      for (const Eigen::Vector2d& corner : *fitted) {
        double nearest = 1e9;
        for (int k = 0; k < 4; ++k) {
          nearest = std::min(nearest, (corner - *camera.ImgFromCam(marker.Corner(k))).norm());
        }
        errors.worst_corner = std::max(errors.worst_corner, nearest);
      }
    }
  }
  errors.fitted /= errors.num_found;
  return errors;
}

TEST(FitCornersTest, SidesAreRightInLinearLightAndAsCamerasGiveIt) {
  for (const bool in_srgb : {false, true}) {
    for (const int blur : {0, 1, 3}) {
      const Errors errors = Measure({1, 0, blur, 0.2}, in_srgb);
      printf("%d %d: detected %.4f fitted %.4f worst %.3f\n", in_srgb, blur, errors.detected / errors.num_found, errors.fitted, errors.worst_corner);
      EXPECT_EQ(errors.num_found, 10);
      EXPECT_LT(std::abs(errors.fitted), 0.002) << in_srgb << " " << blur;
      EXPECT_LT(errors.worst_corner, 0.15) << in_srgb << " " << blur;
    }
  }
}

TEST(FitCornersTest, MirrorImages) {
  const Errors errors = Measure({}, true, true);
  EXPECT_EQ(errors.num_found, 10);
  EXPECT_LT(std::abs(errors.fitted), 0.002);
}

}  // namespace
}  // namespace colmap_seapoint
