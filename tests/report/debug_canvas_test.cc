#include "colmap_seapoint/report/debug_canvas.h"

#include <gtest/gtest.h>

namespace colmap_seapoint {
namespace {

constexpr int kTitleHeight = 30;

using Points = std::vector<Eigen::Vector2d>;

int NumSet(const cv::Mat& mask) { return cv::countNonZero(mask); }

// The colour of a canvas pixel below the title.
Rgb ColorAt(const Canvas& canvas, int x, int y) {
  const Image<uint8_t> image = canvas.WithTitle("");
  return {image.At(x, y + kTitleHeight, 0), image.At(x, y + kTitleHeight, 1),
          image.At(x, y + kTitleHeight, 2)};
}

TEST(CanvasFrameTest, WidePicturesAreReducedSmallOnesAreNot) {
  const CanvasFrame small(400, 300), wide(4000, 3000);
  EXPECT_EQ(small.scale, 1);
  EXPECT_EQ(small.size, cv::Size(400, 300));
  EXPECT_EQ(wide.scale, 0.25);
  EXPECT_EQ(wide.size, cv::Size(1000, 750));
  EXPECT_EQ(wide.Place({10.5, 7.9}), cv::Point(2, 1));
  EXPECT_EQ(wide.Place({-0.1, 3.9}), cv::Point(-1, 0));
}

TEST(MasksTest, DiscsOfThePicturesRadius) {
  const CanvasFrame frame(2000, 1000);  // half size
  EXPECT_EQ(NumSet(DiscMask(frame, {}, 10)), 0);
  const cv::Mat mask = DiscMask(frame, {{100, 200}, {600, 200}}, 40);
  EXPECT_EQ(mask.at<uint8_t>(100, 50), 255);
  EXPECT_EQ(mask.at<uint8_t>(100, 50 + 19), 255);
  EXPECT_EQ(mask.at<uint8_t>(100, 50 + 22), 0);
  EXPECT_EQ(mask.at<uint8_t>(100, 300), 255);
  EXPECT_NEAR(NumSet(mask), 2 * 3.1416 * 20 * 20, 100);
}

TEST(MasksTest, TheHullOfPoints) {
  const CanvasFrame frame(300, 200);
  EXPECT_EQ(NumSet(HullMask(frame, {})), 0);
  const cv::Mat mask = HullMask(frame, {{10, 10}, {100, 10}, {100, 60}, {10, 60}, {50, 30}});
  EXPECT_EQ(NumSet(mask), 91 * 51);
  EXPECT_EQ(mask.at<uint8_t>(10, 10), 255);
  EXPECT_EQ(mask.at<uint8_t>(61, 50), 0);
}

TEST(MasksTest, CellsOfTheFullPicture) {
  const CanvasFrame frame(2000, 1000);
  const CellGrid grid(2000, 1000, 100);
  std::vector<uint8_t> marked(grid.Size(), 0);
  marked[grid.IndexOf(250, 450)] = 1;
  const cv::Mat mask = CellMask(frame, grid, marked);
  EXPECT_EQ(NumSet(mask), 50 * 50);
  EXPECT_EQ(mask.at<uint8_t>(200, 100), 255);
  EXPECT_EQ(mask.at<uint8_t>(249, 149), 255);
  EXPECT_EQ(mask.at<uint8_t>(250, 149), 0);
  // Holds asks with pixels of the full picture, and is false outside.
  EXPECT_TRUE(Holds(frame, mask, {200.0f, 400.0f}));
  EXPECT_TRUE(Holds(frame, mask, {299.9f, 499.9f}));
  EXPECT_FALSE(Holds(frame, mask, {300.1f, 499.0f}));
  EXPECT_FALSE(Holds(frame, mask, {-5.0f, 400.0f}));
  EXPECT_FALSE(Holds(frame, mask, {5000.0f, 400.0f}));
}

TEST(CanvasTest, TintsWhatTheMaskMarks) {
  Canvas canvas(100, 50);
  cv::Mat mask = cv::Mat::zeros(canvas.Frame().size, CV_8UC1);
  mask.at<uint8_t>(20, 30) = 255;
  canvas.Tint(mask, Rgb(200, 100, 50), 0.5);
  EXPECT_EQ(ColorAt(canvas, 30, 20), Rgb(100, 50, 25));
  EXPECT_EQ(ColorAt(canvas, 31, 20), Rgb(0, 0, 0));
  canvas.Tint(mask, Rgb(0, 0, 0), 1);
  EXPECT_EQ(ColorAt(canvas, 30, 20), Rgb(0, 0, 0));
}

TEST(CanvasTest, ShowsThePictureDimmed) {
  ColorImage white(80, 60, 3, 200);
  const Canvas canvas(PictureOf(white), 0.5);
  const Rgb color = ColorAt(canvas, 40, 30);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], 100, 2);
}

TEST(CanvasTest, DrawsDotsCirclesAndOutlines) {
  Canvas canvas(200, 100);
  canvas.Dots({{50, 50}}, Rgb(255, 0, 0));
  EXPECT_EQ(ColorAt(canvas, 50, 50), Rgb(255, 0, 0));
  canvas.Circles({{120, 50}}, 20, Rgb(0, 255, 0));
  EXPECT_EQ(ColorAt(canvas, 120, 50), Rgb(0, 0, 0));
  EXPECT_GT(ColorAt(canvas, 140, 50)[1], 100);
  canvas.Outline(HullMask(canvas.Frame(), {{10, 10}, {30, 10}, {30, 30}, {10, 30}}),
                 Rgb(0, 0, 255));
  EXPECT_EQ(ColorAt(canvas, 10, 20), Rgb(0, 0, 255));
  EXPECT_EQ(ColorAt(canvas, 20, 20), Rgb(0, 0, 0));
}

TEST(CanvasTest, NearDisparitiesAreBright) {
  Canvas canvas(200, 100);
  canvas.Disparities({{{30, 50}, 10}, {{100, 50}, 20}, {{150, 50}, 99}}, 10, Rgb(200, 100, 0),
                     {10, 20});
  EXPECT_EQ(ColorAt(canvas, 30, 50), Rgb(60, 30, 0));  // the far end: a third
  EXPECT_EQ(ColorAt(canvas, 100, 50), Rgb(200, 100, 0));
  EXPECT_EQ(ColorAt(canvas, 150, 50), Rgb(200, 100, 0));  // beyond: as the near end
  EXPECT_EQ(ColorAt(canvas, 36, 50), Rgb(60, 30, 0));     // squares of 12 pixels
  EXPECT_EQ(ColorAt(canvas, 38, 50), Rgb(0, 0, 0));
}

TEST(CanvasTest, ATitleAddsALineAbove) {
  const Canvas canvas(300, 100);
  const Image<uint8_t> image = canvas.WithTitle("words");
  EXPECT_EQ(image.width, 300);
  EXPECT_EQ(image.height, 100 + kTitleHeight);
  EXPECT_EQ(image.At(299, 0, 0), 40);
  int num_bright = 0;
  for (int y = 0; y < kTitleHeight; ++y) {
    for (int x = 0; x < 300; ++x) num_bright += image.At(x, y, 0) > 200 ? 1 : 0;
  }
  EXPECT_GT(num_bright, 20);
}

TEST(SideBySideTest, AGapBetweenAndGreyBelowTheSmaller) {
  const Image<uint8_t> left(20, 10, 3, 1), right(30, 15, 3, 2);
  const Image<uint8_t> both = SideBySide(left, right);
  EXPECT_EQ(both.width, 20 + 10 + 30);
  EXPECT_EQ(both.height, 15);
  EXPECT_EQ(both.At(19, 9, 2), 1);
  EXPECT_EQ(both.At(19, 10, 0), 40);
  EXPECT_EQ(both.At(20, 5, 0), 40);
  EXPECT_EQ(both.At(29, 5, 2), 40);
  EXPECT_EQ(both.At(30, 14, 0), 2);
  EXPECT_EQ(both.At(59, 14, 2), 2);
}

}  // namespace
}  // namespace colmap_seapoint
