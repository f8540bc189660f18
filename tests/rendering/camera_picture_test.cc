#include "colmap_seapoint/rendering/camera_picture.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

using Color = std::array<uint8_t, 3>;
constexpr Color kRed = {255, 0, 0}, kGreen = {0, 255, 0}, kBlack = {0, 0, 0};

// 40 x 30 pixels, f = 20; the camera stands at (0, 0, -10) and looks along z.
Camera MakePinhole() { return MakeCamera(CameraModel::kSimplePinhole, 20, 40, 30); }
const Rigid3d kPose = {Eigen::Quaterniond::Identity(), {0, 0, 10}};

Color At(const CameraPicture& picture, int x, int y) {
  return {picture.Picture().At(x, y, 0), picture.Picture().At(x, y, 1),
          picture.Picture().At(x, y, 2)};
}

int NumPixels(const CameraPicture& picture, const Color& color) {
  int count = 0;
  for (int y = 0; y < picture.Picture().height; ++y) {
    for (int x = 0; x < picture.Picture().width; ++x) count += At(picture, x, y) == color;
  }
  return count;
}

TEST(CameraPictureTest, PointsLieWhereTheCameraSeesThem) {
  CameraPicture picture(MakePinhole(), kPose, 1);
  picture.Add({2.25, -1.25, 0}, kRed);  // (20 + 4.5, 15 - 2.5)
  EXPECT_EQ(At(picture, 24, 12), kRed);
  EXPECT_EQ(NumPixels(picture, kBlack), 40 * 30 - 1);
}

TEST(CameraPictureTest, TheNearerPointIsInFront) {
  CameraPicture picture(MakePinhole(), kPose, 1);
  picture.Add({0.25, 0.25, 0}, kRed);
  picture.Add({0.5, 0.5, 10}, kGreen);  // farther, the same pixel
  EXPECT_EQ(At(picture, 20, 15), kRed);
  picture.Add({0.125, 0.125, -5}, kGreen);
  EXPECT_EQ(At(picture, 20, 15), kGreen);
}

TEST(CameraPictureTest, OutsideAndBehindIsNotDrawn) {
  CameraPicture picture(MakePinhole(), kPose, 1);
  picture.Add({0, 0, -11}, kRed);
  picture.Add({10.5, 0, 0}, kRed);
  picture.Add({0, 8, 0}, kRed);
  EXPECT_EQ(NumPixels(picture, kRed), 0);
}

TEST(CameraPictureTest, LargePointsAreCutAtTheBorder) {
  CameraPicture picture(MakePinhole(), kPose, 3);
  picture.Add({2.25, -1.25, 0}, kRed);
  EXPECT_EQ(NumPixels(picture, kRed), 9);
  EXPECT_EQ(At(picture, 23, 11), kRed);
  EXPECT_EQ(At(picture, 25, 13), kRed);
  picture.Add({-9.75, -7.25, 0}, kGreen);  // (0.5, 0.5): a quarter lies inside
  EXPECT_EQ(NumPixels(picture, kGreen), 4);
}

TEST(CameraPictureTest, WhatDistortionFoldsBackIsLeftOut) {
  Camera camera = MakeCamera(CameraModel::kSimpleRadial, 20, 40, 30);
  camera.params.back() = -0.3;
  CameraPicture picture(camera, kPose, 1);
  picture.Add({5, 0, 0}, kRed);  // u = 0.5, at 20 * (0.5 - 0.3 * 0.125) = 9.25
  EXPECT_EQ(At(picture, 29, 15), kRed);
  // u = 1.5 would be seen at 20 * (1.5 - 0.3 * 3.375) = 9.75, beyond where the lens turns back.
  ASSERT_TRUE(camera.InImage(camera.ImgFromCam({15, 0, 10}).value()));
  picture.Add({15, 0, 0}, kGreen);
  EXPECT_EQ(NumPixels(picture, kGreen), 0);
}

}  // namespace
}  // namespace colmap_seapoint
