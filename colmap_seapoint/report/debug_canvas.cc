#include "colmap_seapoint/report/debug_canvas.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace colmap_seapoint {
namespace {

constexpr int kTitleHeight = 30;
constexpr int kGap = 10;
constexpr uint8_t kDarkGray = 40;

cv::Scalar ToScalar(const Rgb& color) { return cv::Scalar(color[0], color[1], color[2]); }

int Scaled(int length, double scale) {
  return std::max(1, static_cast<int>(std::lround(length * scale)));
}

Image<uint8_t> ToImage(const cv::Mat& rgb) {
  Image<uint8_t> image(rgb.cols, rgb.rows, 3);
  for (int y = 0; y < rgb.rows; ++y) std::memcpy(image.Row(y), rgb.ptr(y), image.Stride());
  return image;
}

}  // namespace

CanvasFrame::CanvasFrame(int picture_width, int picture_height)
    : scale(std::min(1.0, static_cast<double>(kMaxWidth) / picture_width)),
      size(Scaled(picture_width, scale), Scaled(picture_height, scale)) {}

cv::Point CanvasFrame::Place(const Eigen::Vector2d& pixel) const {
  return {static_cast<int>(std::floor(pixel.x() * scale)),
          static_cast<int>(std::floor(pixel.y() * scale))};
}

cv::Mat DiscMask(const CanvasFrame& frame, const std::vector<Eigen::Vector2d>& centers,
                 double radius) {
  cv::Mat mask = cv::Mat::zeros(frame.size, CV_8UC1);
  const int canvas_radius = std::max(1, static_cast<int>(std::lround(radius * frame.scale)));
  for (const Eigen::Vector2d& center : centers) {
    cv::circle(mask, frame.Place(center), canvas_radius, cv::Scalar(255), cv::FILLED);
  }
  return mask;
}

cv::Mat HullMask(const CanvasFrame& frame, const std::vector<Eigen::Vector2d>& points) {
  cv::Mat mask = cv::Mat::zeros(frame.size, CV_8UC1);
  if (points.empty()) return mask;
  std::vector<cv::Point> places, hull;
  for (const Eigen::Vector2d& point : points) places.push_back(frame.Place(point));
  cv::convexHull(places, hull);
  cv::fillConvexPoly(mask, hull, cv::Scalar(255));
  return mask;
}

cv::Mat CellMask(const CanvasFrame& frame, const CellGrid& grid,
                 const std::vector<uint8_t>& marked) {
  cv::Mat mask = cv::Mat::zeros(frame.size, CV_8UC1);
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      if (marked[grid.IndexOf((x + 0.5) / frame.scale, (y + 0.5) / frame.scale)] != 0) {
        mask.at<uint8_t>(y, x) = 255;
      }
    }
  }
  return mask;
}

bool Holds(const CanvasFrame& frame, const cv::Mat& mask, const Eigen::Vector2f& pixel) {
  const cv::Point place = frame.Place(pixel.cast<double>());
  return place.x >= 0 && place.y >= 0 && place.x < mask.cols && place.y < mask.rows &&
         mask.at<uint8_t>(place) != 0;
}

Canvas::Canvas(int picture_width, int picture_height)
    : frame_(picture_width, picture_height), rgb_(cv::Mat::zeros(frame_.size, CV_8UC3)) {}

Canvas::Canvas(const Picture& picture, double brightness)
    : Canvas(picture.luma.width, picture.luma.height) {
  ColorImage color = ColorOf(picture);
  const cv::Mat whole(color.height, color.width, CV_8UC3, color.data.data());
  cv::resize(whole, rgb_, rgb_.size(), 0, 0, cv::INTER_AREA);
  rgb_.convertTo(rgb_, -1, brightness);
}

void Canvas::Tint(const cv::Mat& mask, const Rgb& color, double strength) {
  for (int y = 0; y < rgb_.rows; ++y) {
    for (int x = 0; x < rgb_.cols; ++x) {
      if (mask.at<uint8_t>(y, x) == 0) continue;
      Rgb& value = rgb_.at<Rgb>(y, x);
      for (int c = 0; c < 3; ++c) {
        value[c] = cv::saturate_cast<uint8_t>((1 - strength) * value[c] + strength * color[c]);
      }
    }
  }
}

void Canvas::Outline(const cv::Mat& mask, const Rgb& color) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  cv::drawContours(rgb_, contours, -1, ToScalar(color), 2);
}

void Canvas::Circles(const std::vector<Eigen::Vector2d>& centers, double radius, const Rgb& color) {
  const int canvas_radius = std::max(2, static_cast<int>(std::lround(radius * frame_.scale)));
  for (const Eigen::Vector2d& center : centers) {
    cv::circle(rgb_, frame_.Place(center), canvas_radius, ToScalar(color), 1, cv::LINE_AA);
  }
}

void Canvas::Dots(const std::vector<Eigen::Vector2d>& centers, const Rgb& color) {
  for (const Eigen::Vector2d& center : centers) {
    cv::circle(rgb_, frame_.Place(center), 1, ToScalar(color), cv::FILLED);
  }
}

void Canvas::Disparities(const std::vector<PlacedDisparity>& samples, double size, const Rgb& color,
                         const Eigen::Vector2f& range) {
  const double half = 0.6 * size;  // a little more than its share: lenses spread the samples
  const float span = std::max(1e-6f, range[1] - range[0]);
  for (const PlacedDisparity& sample : samples) {
    const float nearness = std::clamp((sample.disparity - range[0]) / span, 0.0f, 1.0f);
    const Eigen::Vector2d pixel = sample.pixel.cast<double>();
    const cv::Point low = frame_.Place(pixel - Eigen::Vector2d(half, half));
    const cv::Point high = frame_.Place(pixel + Eigen::Vector2d(half, half));
    cv::rectangle(rgb_, low, high, ToScalar(color) * (0.3 + 0.7 * nearness), cv::FILLED);
  }
}

Image<uint8_t> Canvas::WithTitle(const std::string& text) const {
  cv::Mat titled;
  cv::copyMakeBorder(rgb_, titled, kTitleHeight, 0, 0, 0, cv::BORDER_CONSTANT,
                     cv::Scalar::all(kDarkGray));
  cv::putText(titled, text, cv::Point(8, kTitleHeight - 10), cv::FONT_HERSHEY_SIMPLEX, 0.5,
              cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  return ToImage(titled);
}

Image<uint8_t> SideBySide(const Image<uint8_t>& left, const Image<uint8_t>& right) {
  Image<uint8_t> both(left.width + kGap + right.width, std::max(left.height, right.height), 3,
                      kDarkGray);
  for (int y = 0; y < left.height; ++y) std::memcpy(both.Row(y), left.Row(y), left.Stride());
  const size_t offset = static_cast<size_t>(left.width + kGap) * 3;
  for (int y = 0; y < right.height; ++y) {
    std::memcpy(both.Row(y) + offset, right.Row(y), right.Stride());
  }
  return both;
}

}  // namespace colmap_seapoint
