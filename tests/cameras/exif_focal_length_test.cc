// Cameras whose focal length in pixels is known by arithmetic, and EXIF that is wrong about them.
#include "colmap_seapoint/cameras/exif_focal_length.h"

#include <gtest/gtest.h>

#include <cmath>

namespace colmap_seapoint {
namespace {

// 8 mm on a sensor of 16 x 12 mm, 4000 x 3000 pixels: 2000 px.
ExifCamera FocalPlaneCamera() {
  ExifCamera camera;
  camera.maker = "Sea";
  camera.model = "Eye";
  camera.focal_mm = 8;
  camera.pixels_per_mm = 250;
  camera.taken_width = 4000;
  camera.taken_height = 3000;
  return camera;
}

double Focal(const ExifCamera& camera, int width, int height) {
  const auto focal = FocalLengthFromExif(camera, width, height);
  return focal ? focal->px : 0;
}

TEST(ExifFocalLengthTest, The35mmEquivalentComesFirst) {
  ExifCamera camera = FocalPlaneCamera();
  camera.focal_35mm = 28;
  const auto focal = FocalLengthFromExif(camera, 4000, 3000);
  ASSERT_TRUE(focal);
  EXPECT_NEAR(focal->px, 28.0 / 35 * 4000, 1e-9);
  EXPECT_EQ(focal->source, FocalSource::k35mmEquivalent);
  EXPECT_NEAR(Focal(camera, 3000, 4000), 28.0 / 35 * 4000, 1e-9);
}

TEST(ExifFocalLengthTest, ThenTheResolutionOfTheSensor) {
  const auto focal = FocalLengthFromExif(FocalPlaneCamera(), 4000, 3000);
  ASSERT_TRUE(focal);
  EXPECT_NEAR(focal->px, 2000, 1e-9);
  EXPECT_EQ(focal->source, FocalSource::kFocalPlane);
}

TEST(ExifFocalLengthTest, SmallerPicturesTurnedOnesAndCuts) {
  const ExifCamera camera = FocalPlaneCamera();
  EXPECT_NEAR(Focal(camera, 1000, 750), 500, 1e-9);
  EXPECT_NEAR(Focal(camera, 750, 1000), 500, 1e-9);
  EXPECT_NEAR(Focal(camera, 1001, 750), 500.5, 1e-9);  // rounded
  // Cut out: its pixels are the sensor's.
  EXPECT_NEAR(Focal(camera, 4000, 2250), 2000, 1e-9);
  EXPECT_NEAR(Focal(camera, 1500, 1500), 2000, 1e-9);
  ExifCamera equivalent;
  equivalent.focal_35mm = 35;
  equivalent.taken_width = 4000;
  equivalent.taken_height = 3000;
  EXPECT_NEAR(Focal(equivalent, 1500, 1500), 4000, 1e-9);
  EXPECT_NEAR(Focal(equivalent, 1000, 750), 1000, 1e-9);
}

TEST(ExifFocalLengthTest, TheWidthAloneIsEnough) {
  ExifCamera camera = FocalPlaneCamera();
  camera.taken_height = 0;
  EXPECT_NEAR(Focal(camera, 1000, 750), 500, 1e-9);
}

// A larger picture than the one that was taken: nobody knows what its pixels are.
TEST(ExifFocalLengthTest, ASizeThatCannotBeIsPassedOver) {
  ExifCamera camera = FocalPlaneCamera();
  camera.taken_width = 160;
  camera.taken_height = 160;
  EXPECT_EQ(Focal(camera, 4000, 3000), 0);
  camera.focal_35mm = 35;
  EXPECT_NEAR(Focal(camera, 4000, 3000), 4000, 1e-9);
  camera.focal_35mm = 0;
  camera.taken_width = 0;
  EXPECT_EQ(Focal(camera, 4000, 3000), 0);
}

TEST(ExifFocalLengthTest, ThenTheTableOfSensors) {
  ExifCamera camera;
  camera.maker = "OLYMPUS CORPORATION";
  camera.model = "TG-6";
  camera.focal_mm = 4.5;
  const auto focal = FocalLengthFromExif(camera, 4000, 3000);
  ASSERT_TRUE(focal);
  EXPECT_EQ(focal->source, FocalSource::kSensorTable);
  EXPECT_NEAR(focal->px, 25.0 / 34.6 * 4000, 40);  // its data sheet: 25 mm
  // 16 to 9 and 1 to 1 of the same sensor: as wide, as high.
  EXPECT_NEAR(Focal(camera, 4000, 2250), focal->px, 1e-6);
  EXPECT_NEAR(Focal(camera, 3000, 3000), focal->px, 1e-6);
}

// Programs that make a picture smaller write its new size, and leave the resolution.
TEST(ExifFocalLengthTest, TheTableOfSensorsDoubtsTheResolution) {
  ExifCamera camera;
  camera.maker = "SONY";
  camera.model = "ILCE-7M3";
  camera.focal_mm = 28;
  camera.pixels_per_mm = 6000 / 35.8;
  camera.taken_width = 6000;
  camera.taken_height = 4000;
  EXPECT_EQ(FocalLengthFromExif(camera, 1500, 1000)->source, FocalSource::kFocalPlane);
  EXPECT_NEAR(Focal(camera, 1500, 1000), 28 / 35.8 * 1500, 1);
  camera.taken_width = 1500;
  camera.taken_height = 1000;
  EXPECT_EQ(FocalLengthFromExif(camera, 1500, 1000)->source, FocalSource::kSensorTable);
  EXPECT_NEAR(Focal(camera, 1500, 1000), 28 / 35.8 * 1500, 10);
}

TEST(ExifFocalLengthTest, NothingAndNonsense) {
  EXPECT_EQ(Focal({}, 400, 300), 0);
  ExifCamera camera;
  camera.focal_mm = 8;
  EXPECT_EQ(Focal(camera, 400, 300), 0);
  camera.focal_35mm = 1;  // a view of 173 degrees
  EXPECT_EQ(Focal(camera, 400, 300), 0);
  camera.focal_35mm = 1e300;
  EXPECT_EQ(Focal(camera, 400, 300), 0);
  camera = FocalPlaneCamera();
  camera.focal_mm = 0;
  EXPECT_EQ(Focal(camera, 4000, 3000), 0);
  camera = FocalPlaneCamera();
  camera.pixels_per_mm = 1e-300;
  EXPECT_EQ(Focal(camera, 4000, 3000), 0);
  camera.pixels_per_mm = 1e300;
  EXPECT_EQ(Focal(camera, 4000, 3000), 0);
}

}  // namespace
}  // namespace colmap_seapoint
