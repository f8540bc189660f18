// Zero-mean normalised cross-correlation of square windows on 8-bit rows: integers up to the last
// division. It is blind to gain and offset, which differ between pictures under moving light.
#pragma once

#include <array>
#include <cstdint>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

inline constexpr int kMaxZnccWindow = 15;

// The reference window, prepared once and compared with many.
class ZnccReference {
 public:
  // Window of `size` (odd, <= kMaxZnccWindow) centred on (x, y). The 16 bytes from its left edge on
  // must exist in every row, here and in Score's picture.
  ZnccReference(const GrayImage& picture, int x, int y, int size);

  bool HasTexture() const { return variance_ >= kMinVariance; }
  // -1..1; -1 when the other window has no texture.
  float Score(const GrayImage& picture, int x, int y) const;

 private:
  static constexpr double kMinVariance = 1.0;  // grey levels squared

  alignas(32) std::array<int16_t, kMaxZnccWindow * 16> rows_{};
  int size_ = 0;
  int32_t sum_ = 0;
  int64_t scatter_ = 0;  // n * sum of squares - sum^2
  double variance_ = 0;
};

}  // namespace colmap_seapoint
