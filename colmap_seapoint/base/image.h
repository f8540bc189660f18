// A plain raster: rows top to bottom, pixels left to right, channels interleaved, no row padding.
// Pixel (column x, row y) covers [x, x+1) x [y, y+1); its centre is at (x + 0.5, y + 0.5), as in
// COLMAP. All keypoints, camera projections and disparities of this project use that frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace colmap_seapoint {

template <typename T>
struct Image {
  int width = 0;
  int height = 0;
  int channels = 1;
  std::vector<T> data;

  Image() = default;
  Image(int w, int h, int c = 1, T value = T())
      : width(w),
        height(h),
        channels(c),
        data(static_cast<size_t>(w) * static_cast<size_t>(h) * static_cast<size_t>(c), value) {}

  bool Empty() const { return data.empty(); }
  size_t Stride() const { return static_cast<size_t>(width) * static_cast<size_t>(channels); }
  T* Row(int y) { return data.data() + static_cast<size_t>(y) * Stride(); }
  const T* Row(int y) const { return data.data() + static_cast<size_t>(y) * Stride(); }
  T& At(int x, int y, int c = 0) { return Row(y)[static_cast<size_t>(x * channels + c)]; }
  const T& At(int x, int y, int c = 0) const {
    return Row(y)[static_cast<size_t>(x * channels + c)];
  }
  bool Contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};

using GrayImage = Image<uint8_t>;   // 1 channel
using ColorImage = Image<uint8_t>;  // 3 channels, red green blue
using FloatImage = Image<float>;

}  // namespace colmap_seapoint
