// A picture reduced to screen size, and what is drawn on it. Positions are given in pixels of the
// full picture. For debug_figures.cc only.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "colmap_seapoint/base/picture.h"
#include "densify/match/cell_grid.h"

namespace colmap_seapoint {

using Rgb = cv::Vec3b;

// A disparity at its place in picture 1.
struct PlacedDisparity {
  Eigen::Vector2f pixel;
  float disparity;
};

// How a picture is reduced: to kMaxWidth pixels where it is wider.
struct CanvasFrame {
  static constexpr int kMaxWidth = 1000;

  CanvasFrame(int picture_width, int picture_height);
  // The canvas pixel that shows a pixel of the picture.
  cv::Point Place(const Eigen::Vector2d& pixel) const;

  double scale;  // canvas pixels a picture pixel
  cv::Size size;
};

// The masks are as large as the canvas: 255 inside, 0 outside. This one: within `radius` of a
// point.
cv::Mat DiscMask(const CanvasFrame& frame, const std::vector<Eigen::Vector2d>& centers,
                 double radius);
// Inside the points' convex hull.
cv::Mat HullMask(const CanvasFrame& frame, const std::vector<Eigen::Vector2d>& points);
// In the marked cells.
cv::Mat CellMask(const CanvasFrame& frame, const CellGrid& grid,
                 const std::vector<uint8_t>& marked);
// Whether the mask is 255 at a pixel of the picture.
bool Holds(const CanvasFrame& frame, const cv::Mat& mask, const Eigen::Vector2f& pixel);

class Canvas {
 public:
  // Black, for a picture of this size.
  Canvas(int picture_width, int picture_height);
  // The picture, its brightness multiplied.
  Canvas(const Picture& picture, double brightness);

  const CanvasFrame& Frame() const { return frame_; }

  void Tint(const cv::Mat& mask, const Rgb& color, double strength);
  void Outline(const cv::Mat& mask, const Rgb& color);
  void Circles(const std::vector<Eigen::Vector2d>& centers, double radius, const Rgb& color);
  void Dots(const std::vector<Eigen::Vector2d>& centers, const Rgb& color);
  // Squares of `size` pixels of the picture; near surface in full colour, far in a third of it.
  void Disparities(const std::vector<PlacedDisparity>& samples, double size, const Rgb& color,
                   const Eigen::Vector2f& range);

  // What was drawn, with a line of text above it.
  Image<uint8_t> WithTitle(const std::string& text) const;

 private:
  CanvasFrame frame_;
  cv::Mat rgb_;
};

// The two side by side on dark grey, a gap between them.
Image<uint8_t> SideBySide(const Image<uint8_t>& left, const Image<uint8_t>& right);

}  // namespace colmap_seapoint
