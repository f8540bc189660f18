#include "feature/descriptor/sift_descriptor.h"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "colmap_seapoint/base/error.h"
#include "feature/descriptor/rbrief_descriptor.h"

namespace colmap_seapoint {

namespace {

// All in pixels of half the described size.
constexpr double kWindow = 28;      // the width of the 4 x 4 cells
constexpr double kBlurSigma = 1.6;  // OpenCV's own; 0.7 of the window's twelfth
constexpr double kNoiseSigma = 1;   // before the box, so that the 8 bits hold more than noise
constexpr int kBox = 13;            // of the local mean

constexpr size_t kNumCells = 4;  // a side
constexpr size_t kNumDirections = 8;

// The picture less its local mean, as the 8 bits that cv::SIFT asks for: the standard deviation
// becomes 16 levels, so that hazy pictures are not cut to a few steps and eight times as much fits.
cv::Mat LocalDetail(const GrayImage& picture, int reduction) {
  const cv::Size size(picture.width / reduction, picture.height / reduction);
  const cv::Mat whole(picture.height, picture.width, CV_8U,
                      const_cast<uint8_t*>(picture.data.data()), picture.Stride());
  // What is left over at the right and lower edge is dropped: no pixel may move.
  const cv::Mat covered = whole(cv::Rect(0, 0, size.width * reduction, size.height * reduction));
  cv::Mat reduced, smooth, mean, levels;
  covered.convertTo(reduced, CV_32F);
  cv::resize(reduced, reduced, size, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(reduced, smooth, cv::Size(), kNoiseSigma, 0, cv::BORDER_REPLICATE);
  cv::blur(smooth, mean, {kBox, kBox}, {-1, -1}, cv::BORDER_REPLICATE);
  const cv::Mat detail = smooth - mean;
  cv::Scalar ignored, deviation;
  cv::meanStdDev(detail, ignored, deviation);
  detail.convertTo(levels, CV_8U, 16 / std::max(deviation[0], 0.05), 128);
  return levels;
}

// The same as COLMAP: L1-normalised, square roots, times 512, rounded, at most 255.
SiftDescriptor ToRootSift(const float* values) {
  float sum = 0;
  SiftDescriptor descriptor{};
  for (size_t i = 0; i < descriptor.size(); ++i) sum += values[i];
  if (sum <= 0) return descriptor;
  for (size_t i = 0; i < descriptor.size(); ++i) {
    const float scaled = std::round(512 * std::sqrt(values[i] / sum));
    descriptor[i] = static_cast<uint8_t>(std::min(scaled, 255.0f));
  }
  return descriptor;
}

}  // namespace

std::vector<SiftDescriptor> DescribeBySift(const GrayImage& picture,
                                           const std::vector<SeaPoint>& points) {
  if (points.empty()) return {};
  const int reduction = 2 * DescriptionReduction(picture);
  std::vector<cv::KeyPoint> keypoints;
  for (const SeaPoint& point : points) {
    const auto scale = static_cast<float>(reduction);
    // OpenCV puts 0 at the middle of the first pixel, and its cells are 1.5 sizes wide.
    keypoints.emplace_back(point.x / scale - 0.5f, point.y / scale - 0.5f,
                           static_cast<float>(kWindow / 6), 0.0f);
  }
  // One layer an octave, and of that only the first is used: the window's size is given.
  const auto sift = cv::SIFT::create(0, 1, 0.04, 10, kBlurSigma);
  cv::Mat values;
  sift->compute(LocalDetail(picture, reduction), keypoints, values);
  SEAPOINT_CHECK(keypoints.size() == points.size() &&
                 values.rows == static_cast<int>(points.size()) && values.type() == CV_32F);
  std::vector<SiftDescriptor> descriptors;
  descriptors.reserve(points.size());
  for (int i = 0; i < values.rows; ++i) descriptors.push_back(ToRootSift(values.ptr<float>(i)));
  return descriptors;
}

SiftDescriptor TurnSiftDescriptor(const SiftDescriptor& descriptor, int quarters) {
  SiftDescriptor turned = descriptor;
  // OpenCV's cells run through rows, then columns; its directions from x to the picture's top.
  for (unsigned i = 0; i < static_cast<unsigned>(quarters) % 4; ++i) {
    const SiftDescriptor before = turned;
    for (size_t row = 0; row < kNumCells; ++row) {
      for (size_t column = 0; column < kNumCells; ++column) {
        const size_t from = (row * kNumCells + column) * kNumDirections;
        const size_t to = (column * kNumCells + kNumCells - 1 - row) * kNumDirections;
        for (size_t k = 0; k < kNumDirections; ++k) {
          turned[to + (k + kNumDirections - 2) % kNumDirections] = before[from + k];
        }
      }
    }
  }
  return turned;
}

}  // namespace colmap_seapoint
