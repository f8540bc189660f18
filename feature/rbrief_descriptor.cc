#include "feature/rbrief_descriptor.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "feature/rbrief_pattern.h"

namespace colmap_seapoint {

namespace {

constexpr int kCentroidRadius = 15;
constexpr double kSmoothingSigma = 2.5;  // of the grey levels that are compared

GrayImage Smooth(const GrayImage& picture) {
  GrayImage smooth(picture.width, picture.height);
  const cv::Mat source(picture.height, picture.width, CV_8U,
                       const_cast<uint8_t*>(picture.data.data()));
  cv::Mat target(smooth.height, smooth.width, CV_8U, smooth.data.data());
  cv::GaussianBlur(source, target, cv::Size(11, 11), kSmoothingSigma);
  return smooth;
}

// Half width of the disc's rows. Rounded down: exactly the pixels with x^2 + y^2 <= radius^2, as
// wide as high. (Rounded to nearest, columns are cut otherwise than rows, and quarter turns of a
// picture turn the orientation by up to 7 degrees more or less.)
std::vector<int> DiscHalfWidths() {
  std::vector<int> half_widths;
  for (int y = 0; y <= kCentroidRadius; ++y) {
    half_widths.push_back(static_cast<int>(
        std::sqrt(static_cast<double>(kCentroidRadius * kCentroidRadius - y * y))));
  }
  return half_widths;
}

float CentroidOrientation(const GrayImage& picture, int x, int y,
                          const std::vector<int>& half_widths) {
  int moment_x = 0, moment_y = 0;
  for (int v = -kCentroidRadius; v <= kCentroidRadius; ++v) {
    const int half_width = half_widths[static_cast<size_t>(std::abs(v))];
    const uint8_t* row = picture.Row(y + v) + x;
    int row_sum = 0;
    for (int u = -half_width; u <= half_width; ++u) {
      moment_x += u * row[u];
      row_sum += row[u];
    }
    moment_y += v * row_sum;
  }
  return std::atan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

Descriptor Describe(const GrayImage& smooth, int x, int y, float orientation) {
  const float c = std::cos(orientation), s = std::sin(orientation);
  auto sample = [&](const std::array<int8_t, 2>& offset) {
    const int u = static_cast<int>(std::lrint(c * offset[0] - s * offset[1]));
    const int v = static_cast<int>(std::lrint(s * offset[0] + c * offset[1]));
    return smooth.At(x + u, y + v);
  };
  const std::array<RBriefTest, 256>& pattern = RBriefPattern();
  Descriptor descriptor{};
  for (size_t bit = 0; bit < 256; ++bit) {
    const RBriefTest& test = pattern[bit];
    if (sample(test.first) < sample(test.second)) {
      descriptor[bit / 8] = static_cast<uint8_t>(descriptor[bit / 8] | (1u << (bit % 8)));
    }
  }
  return descriptor;
}

}  // namespace

std::vector<Descriptor> DescribeSeaPoints(const GrayImage& picture, std::vector<SeaPoint>* points) {
  std::vector<Descriptor> descriptors;
  if (points->empty()) return descriptors;
  const GrayImage smooth = Smooth(picture);
  const std::vector<int> half_widths = DiscHalfWidths();
  descriptors.reserve(points->size());
  for (SeaPoint& point : *points) {
    const int x = static_cast<int>(point.x), y = static_cast<int>(point.y);
    point.orientation = CentroidOrientation(smooth, x, y, half_widths);
    descriptors.push_back(Describe(smooth, x, y, point.orientation));
  }
  return descriptors;
}

}  // namespace colmap_seapoint
