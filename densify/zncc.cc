#include "densify/zncc.h"

#include <cmath>

#include "colmap_seapoint/base/vector_clones.h"

namespace colmap_seapoint {

namespace {

struct RightSums {
  int32_t sum, squares, products;
};

// Lane masks: 1 inside a window of the given size, 0 beyond it.
struct LaneMask {
  alignas(32) int16_t lanes[16];
  explicit LaneMask(int size) {
    for (int i = 0; i < 16; ++i) lanes[i] = i < size ? 1 : 0;
  }
};

SEAPOINT_VECTOR_CLONES
RightSums SumRows(const int16_t* left, const uint8_t* right, size_t stride, int size,
                  const int16_t* mask) {
  int32_t sum = 0, squares = 0, products = 0;
  for (int row = 0; row < size; ++row) {
    for (int i = 0; i < 16; ++i) {
      const int16_t value = static_cast<int16_t>(right[i] * mask[i]);
      sum += value;
      squares += value * value;
      products += value * left[i];
    }
    left += 16;
    right += stride;
  }
  return {sum, squares, products};
}

const int16_t* MaskOf(int size) {
  static const LaneMask masks[] = {LaneMask(5),  LaneMask(7),  LaneMask(9),
                                   LaneMask(11), LaneMask(13), LaneMask(15)};
  return masks[(size - 5) / 2].lanes;
}

}  // namespace

ZnccReference::ZnccReference(const GrayImage& picture, int x, int y, int size) : size_(size) {
  const int half = size / 2;
  int32_t squares = 0;
  for (int row = 0; row < size; ++row) {
    const uint8_t* source = picture.Row(y - half + row) + x - half;
    for (int i = 0; i < size; ++i) {
      rows_[static_cast<size_t>(row * 16 + i)] = source[i];
      sum_ += source[i];
      squares += source[i] * source[i];
    }
  }
  const int64_t count = static_cast<int64_t>(size) * size;
  scatter_ = count * squares - static_cast<int64_t>(sum_) * sum_;
  variance_ = static_cast<double>(scatter_) / static_cast<double>(count * count);
}

float ZnccReference::Score(const GrayImage& picture, int x, int y) const {
  const int half = size_ / 2;
  const RightSums right = SumRows(rows_.data(), picture.Row(y - half) + x - half, picture.Stride(),
                                  size_, MaskOf(size_));
  const int64_t count = static_cast<int64_t>(size_) * size_;
  const int64_t scatter = count * right.squares - static_cast<int64_t>(right.sum) * right.sum;
  if (static_cast<double>(scatter) < kMinVariance * static_cast<double>(count * count)) return -1;
  const int64_t covariance = count * right.products - static_cast<int64_t>(sum_) * right.sum;
  return static_cast<float>(
      static_cast<double>(covariance) /
      std::sqrt(static_cast<double>(scatter_) * static_cast<double>(scatter)));
}

}  // namespace colmap_seapoint
