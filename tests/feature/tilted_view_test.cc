#include "feature/tilted_view.h"

#include <gtest/gtest.h>

#include "feature/extract_features.h"
#include "feature/match_features.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {
namespace {

constexpr double kDistance = 2;

Camera TestCamera() { return MakeCamera(CameraModel::kSimplePinhole, 800, 640, 480); }

// Flat ground with texture, z = 0, seen from all around: upright, `tilt_deg` from straight down,
// from the direction `side_deg`.
Viewpoint Around(double tilt_deg, double side_deg) {
  const double radian = M_PI / 180;
  const Eigen::AngleAxisd side(side_deg * radian, Eigen::Vector3d::UnitZ());
  const Eigen::AngleAxisd tilt(-tilt_deg * radian, Eigen::Vector3d::UnitX());
  Viewpoint viewpoint;
  viewpoint.camera = TestCamera();
  viewpoint.cam_from_world.rotation = Eigen::Quaterniond(tilt) * Eigen::Quaterniond(side);
  viewpoint.cam_from_world.translation = {0, 0, kDistance};
  return viewpoint;
}

GrayImage PictureFrom(const Viewpoint& viewpoint) {
  const ColorImage color = TakePicture(FlatWorld(0), viewpoint);
  GrayImage gray(color.width, color.height);
  for (int y = 0; y < gray.height; ++y) {
    for (int x = 0; x < gray.width; ++x) gray.At(x, y) = color.At(x, y, 1);
  }
  return gray;
}

// How many matches show one place of the ground, and how many do not.
struct Score {
  int right = 0, wrong = 0;
};

template <typename PixelOf>
Score ScoreOf(const FeatureMatches& matches, const Viewpoint& a, const Viewpoint& b,
              const PixelOf& pixel_of) {
  Score score;
  for (const FeatureMatch& match : matches) {
    const auto place = SurfaceAt(FlatWorld(0), a, pixel_of(0, match.idx1));
    const auto pixel = place ? b.camera.ImgFromCam(b.cam_from_world * *place) : std::nullopt;
    const bool is_right = pixel && (*pixel - pixel_of(1, match.idx2)).norm() < 3;
    ++(is_right ? score.right : score.wrong);
  }
  return score;
}

TEST(TiltedViewTest, TiesPicturesFromDifferentSidesThatSeaPointsDoNot) {
  const Viewpoint a = Around(45, 0), b = Around(45, 90);
  const GrayImage picture_a = PictureFrom(a), picture_b = PictureFrom(b);
  const SeaPointExtractionOptions options;
  const Features plain_a = ExtractFeatures(picture_a, {}, options).features;
  const Features plain_b = ExtractFeatures(picture_b, {}, options).features;
  const auto plain = MatchFeatures(a.camera, plain_a, b.camera, plain_b, {}).geometry.inliers;
  const Score without = ScoreOf(plain, a, b, [&](int side, uint32_t i) {
    const SeaPoint& point = (side == 0 ? plain_a : plain_b).points[i];
    return Eigen::Vector2d(point.x, point.y);
  });

  // The tilt is not known to better than five degrees.
  const TiltedView view_a = ExtractTiltedView(picture_a, {}, a.camera, 40, options);
  const TiltedView view_b = ExtractTiltedView(picture_b, {}, b.camera, 40, options);
  const auto tied =
      MatchFeatures(view_a.camera, view_a.features, view_b.camera, view_b.features, {})
          .geometry.inliers;
  const Score with = ScoreOf(tied, a, b, [&](int side, uint32_t i) {
    return (side == 0 ? view_a : view_b).in_picture[i];
  });
  EXPECT_GT(with.right, 300);
  EXPECT_LT(20 * with.wrong, with.right);
  EXPECT_GT(with.right, 5 * without.right);
}

TEST(TiltedViewTest, TheViewIsThatOfAPinholeAboveTheGround) {
  const Viewpoint a = Around(45, 20);
  const TiltedView view = ExtractTiltedView(PictureFrom(a), {}, a.camera, 45, {});
  ASSERT_GT(view.features.points.size(), 1000u);
  ASSERT_EQ(view.in_picture.size(), view.features.points.size());
  // A turn of the camera by the tilt takes every ray of the picture to that of the view.
  const Eigen::AngleAxisd turn(45 * M_PI / 180, Eigen::Vector3d::UnitX());
  for (size_t i = 0; i < view.in_picture.size(); ++i) {
    const auto ray = a.camera.CamFromImg(view.in_picture[i]);
    ASSERT_TRUE(ray && a.camera.InImage(view.in_picture[i]));
    const auto pixel = view.camera.ImgFromCam(turn * Eigen::Vector3d(ray->x(), ray->y(), 1));
    ASSERT_TRUE(pixel);
    const SeaPoint& point = view.features.points[i];
    EXPECT_LT((*pixel - Eigen::Vector2d(point.x, point.y)).norm(), 0.01);
  }
}

TEST(TiltedViewTest, WhatTheMaskCoversIsNotInTheView) {
  const Viewpoint a = Around(45, 0);
  GrayImage mask(640, 480, 1, 255);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < 320; ++x) mask.At(x, y) = 0;
  }
  const TiltedView view = ExtractTiltedView(PictureFrom(a), mask, a.camera, 45, {});
  ASSERT_FALSE(view.in_picture.empty());
  for (const Eigen::Vector2d& pixel : view.in_picture) EXPECT_GT(pixel.x(), 318);
}

TEST(TiltedViewTest, NothingToSee) {
  EXPECT_TRUE(ExtractTiltedView({}, {}, TestCamera(), 40, {}).in_picture.empty());
  EXPECT_TRUE(
      ExtractTiltedView(GrayImage(900, 700, 1, 90), {}, TestCamera(), 40, {}).in_picture.empty());
  const Camera tiny = MakeCamera(CameraModel::kSimplePinhole, 30, 20, 20);
  EXPECT_TRUE(ExtractTiltedView(GrayImage(20, 20, 1, 90), {}, tiny, 40, {}).in_picture.empty());
}

}  // namespace
}  // namespace colmap_seapoint
