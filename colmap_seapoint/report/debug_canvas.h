// A picture reduced to screen size and what is drawn on it. Positions are given in pixels of the
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

class Canvas {
 public:
  static constexpr int kMaxWidth = 1000;

  Canvas() = default;
  // Black, for a picture of this size.
  Canvas(int picture_width, int picture_height);
  // The picture, its brightness multiplied.
  Canvas(const Picture& picture, double brightness);

  bool Empty() const { return rgb_.empty(); }
  // 255 within `radius` of a point / inside the points' convex hull, as large as the canvas.
  cv::Mat Discs(const std::vector<Eigen::Vector2d>& centers, double radius) const;
  cv::Mat Hull(const std::vector<Eigen::Vector2d>& points) const;
  // 255 in the marked cells.
  cv::Mat Cells(const CellGrid& grid, const std::vector<uint8_t>& marked) const;
  bool Holds(const cv::Mat& mask, const Eigen::Vector2f& pixel) const;

  void Tint(const cv::Mat& mask, const Rgb& color, double strength);
  void Outline(const cv::Mat& mask, const Rgb& color);
  void Circles(const std::vector<Eigen::Vector2d>& centers, double radius, const Rgb& color);
  void Dots(const std::vector<Eigen::Vector2d>& centers, const Rgb& color);
  // Squares of `size` pixels of the picture; near surface in full colour, far in a third of it.
  void Disparities(const std::vector<PlacedDisparity>& samples, double size, const Rgb& color,
                   const Eigen::Vector2f& range);

  // A line of text above everything.
  void Title(const std::string& text);
  // Beside this one, a gap between them.
  Canvas Beside(const Canvas& right) const;
  Image<uint8_t> ToImage() const;

 private:
  cv::Point Place(const Eigen::Vector2d& pixel) const;

  cv::Mat rgb_;
  double scale_ = 1;  // canvas pixels per picture pixel
};

}  // namespace colmap_seapoint
