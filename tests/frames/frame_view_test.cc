// Overlap and sharpness of views whose motion is known.
#include "colmap_seapoint/frames/frame_view.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/synthetic/video_writer.h"

namespace colmap_seapoint {
namespace {

constexpr int kWidth = 640, kHeight = 360;

const GrayImage& Seabed() {
  static const GrayImage seabed = MakeSeabed(1600, 900, 3);
  return seabed;
}

// Of the seabed after a transform, destination pixel -> seabed pixel.
FrameView Seen(const cv::Matx33d& seabed_from_frame) {
  const GrayImage& seabed = Seabed();
  const cv::Mat from(seabed.height, seabed.width, CV_8U, const_cast<uint8_t*>(seabed.data.data()));
  GrayImage view(kWidth, kHeight);
  cv::Mat target(kHeight, kWidth, CV_8U, view.data.data());
  cv::warpPerspective(from, target, seabed_from_frame, target.size(),
                      cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
  return ViewOf(view);
}

// Moved, turned and scaled about the frame's middle, which looks at (x, y).
cv::Matx33d Pose(double x, double y, double turn_deg, double scale) {
  const double c = scale * std::cos(turn_deg * CV_PI / 180);
  const double s = scale * std::sin(turn_deg * CV_PI / 180);
  return cv::Matx33d(c, -s, x, s, c, y, 0, 0, 1) *
         cv::Matx33d(1, 0, -kWidth / 2.0, 0, 1, -kHeight / 2.0, 0, 0, 1);
}

TEST(FrameViewTest, OverlapOfKnownMotions) {
  const FrameView first = Seen(Pose(800, 450, 0, 1));
  EXPECT_NEAR(OverlapOf(first, first), 1, 1e-6);
  EXPECT_NEAR(OverlapOf(first, Seen(Pose(800 + 128, 450, 0, 1))), 0.8, 0.01);
  EXPECT_NEAR(OverlapOf(first, Seen(Pose(800 + 128, 450 - 72, 0, 1))), 0.64, 0.01);
  // Half as near: a quarter of what is seen was.
  EXPECT_NEAR(OverlapOf(first, Seen(Pose(800, 450, 0, 1.25))), 1 / 1.5625, 0.02);
  EXPECT_NEAR(OverlapOf(first, Seen(Pose(800, 450, 180, 1))), 1, 0.02);
  // On its side, the frame shares a square of it.
  EXPECT_NEAR(OverlapOf(first, Seen(Pose(800, 450, 90, 1))), 360.0 / 640, 0.02);
}

TEST(FrameViewTest, ViewsOfTwoPlacesDoNotOverlap) {
  EXPECT_EQ(OverlapOf(Seen(Pose(400, 250, 0, 1)), Seen(Pose(1200, 650, 0, 1))), 0);
  const FrameView flat = ViewOf(GrayImage(kWidth, kHeight, 1, 90));
  EXPECT_EQ(OverlapOf(flat, flat), 0);
}

TEST(FrameViewTest, ParallaxLowersOverlapWithTheSamePlaceInView) {
  const FrameView first = Seen(Pose(800, 450, 0, 1));
  // As from 10 degrees aside, with a focal length of 600 pixels: what is on the left comes nearer,
  // what is on the right goes away.
  const cv::Matx33d tilt(1, 0, 0, 0, 1, 0, 3e-4, 0, 1);
  const cv::Matx33d middle(1, 0, kWidth / 2.0, 0, 1, kHeight / 2.0, 0, 0, 1);
  const FrameView tilted = Seen(Pose(800, 450, 0, 1) * middle * tilt * middle.inv());
  const double overlap = OverlapOf(first, tilted);
  // 25 degrees are as much as a fifth of the picture's width.
  EXPECT_NEAR(overlap, 1 - 0.2 * 10 / 25, 0.04);
}

TEST(FrameViewTest, BlurLowersSharpness) {
  const GrayImage sharp = Crop(Seabed(), 100, 100, kWidth, kHeight);
  double last = Sharpness(sharp);
  for (const int blur : {3, 6, 12}) {
    const double now = Sharpness(Crop(Seabed(), 100, 100, kWidth, kHeight, blur));
    EXPECT_LT(now, 0.9 * last) << blur;
    last = now;
  }
  EXPECT_EQ(Sharpness(GrayImage(1, 1, 1, 7)), 0);
  EXPECT_EQ(Sharpness(GrayImage(9, 9, 1, 7)), 0);
}

}  // namespace
}  // namespace colmap_seapoint
