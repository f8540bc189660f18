#include "feature/local_contrast.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "colmap_seapoint/base/vector_clones.h"

namespace colmap_seapoint {

namespace {

// In 1/16 grey levels.
Image<uint16_t> Smooth(const GrayImage& picture) {
  Image<uint16_t> smooth(picture.width, picture.height);
  std::transform(picture.data.begin(), picture.data.end(), smooth.data.begin(),
                 [](uint8_t level) { return static_cast<uint16_t>(16 * level); });
  cv::Mat levels(smooth.height, smooth.width, CV_16U, smooth.data.data());
  cv::GaussianBlur(levels, levels, cv::Size(13, 13), kContrastSigma, 0, cv::BORDER_REPLICATE);
  return smooth;
}

SEAPOINT_VECTOR_CLONES
void SlideDown(const uint16_t* entering, const uint16_t* leaving, int width, uint32_t* sums) {
  for (int x = 0; x < width; ++x) sums[x] += static_cast<uint32_t>(entering[x] - leaving[x]);
}

// The window of `length` places that lies within 0..size-1 and nearest to `center`: its first place.
int WindowBegin(int center, int length, int size) {
  return std::clamp(center - length / 2, 0, size - length);
}

// One row: contrast = level - mean of the box, the column sums being those of the box's rows.
void SubtractMean(const uint16_t* smooth, const std::vector<uint32_t>& column_sums, int length,
                  uint32_t box_size, int16_t* out) {
  const int width = static_cast<int>(column_sums.size());
  uint64_t sum = 0;
  for (int x = 0; x < length; ++x) sum += column_sums[static_cast<size_t>(x)];
  // mean = sum / box_size, as a product: exact to 1 in 2^20 of a level.
  const uint64_t inverse = ((uint64_t{1} << 32) + box_size / 2) / box_size;
  for (int x = 0, begin = 0; x < width; ++x) {
    if (begin != WindowBegin(x, length, width)) {
      sum += column_sums[static_cast<size_t>(begin + length)];
      sum -= column_sums[static_cast<size_t>(begin)];
      ++begin;
    }
    const int mean = static_cast<int>((sum * inverse + (uint64_t{1} << 31)) >> 32);
    out[x] = static_cast<int16_t>(smooth[x] - mean);
  }
}

}  // namespace

Image<int16_t> LocalContrast(const GrayImage& picture) {
  Image<int16_t> contrast(picture.width, picture.height);
  if (picture.Empty()) return contrast;
  const Image<uint16_t> smooth = Smooth(picture);
  const int length_x = std::min(2 * kContrastBoxRadius + 1, picture.width);
  const int length_y = std::min(2 * kContrastBoxRadius + 1, picture.height);
  const auto box_size = static_cast<uint32_t>(length_x * length_y);
  const std::vector<uint16_t> nothing(static_cast<size_t>(picture.width), 0);
  std::vector<uint32_t> column_sums(static_cast<size_t>(picture.width), 0);
  for (int y = 0; y < length_y; ++y) {
    SlideDown(smooth.Row(y), nothing.data(), picture.width, column_sums.data());
  }
  for (int y = 0, begin = 0; y < picture.height; ++y) {
    if (begin != WindowBegin(y, length_y, picture.height)) {
      SlideDown(smooth.Row(begin + length_y), smooth.Row(begin), picture.width,
                column_sums.data());
      ++begin;
    }
    SubtractMean(smooth.Row(y), column_sums, length_x, box_size, contrast.Row(y));
  }
  return contrast;
}

}  // namespace colmap_seapoint
