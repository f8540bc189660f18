// A few rows of scratch memory for vector code: each starts at a cache line and goes on for
// kRowSlack elements behind its end, so that whole vectors may be read and written there.
#pragma once

#include <algorithm>
#include <cstddef>

#include "hwy/aligned_allocator.h"

namespace colmap_seapoint {

constexpr size_t kRowSlack = 256;  // elements; twice the lanes of a 128-byte vector of bytes

template <typename T>
class PaddedRows {
 public:
  PaddedRows(size_t num_rows, size_t width) : stride_(Stride(width)) {
    data_ = hwy::AllocateAligned<T>(num_rows * stride_);
    std::fill(data_.get(), data_.get() + num_rows * stride_, T(0));
  }
  T* Row(size_t index) { return data_.get() + index * stride_; }
  const T* Row(size_t index) const { return data_.get() + index * stride_; }
  size_t stride() const { return stride_; }

 private:
  // Whole cache lines, and an odd number of them: rows that lie a power of two apart would all
  // compete for the same few places of the cache.
  static size_t Stride(size_t width) {
    constexpr size_t kLine = 64 / sizeof(T);
    const size_t num_lines = (width + kRowSlack + kLine - 1) / kLine;
    return (num_lines | 1) * kLine;
  }

  size_t stride_;
  hwy::AlignedFreeUniquePtr<T[]> data_;
};

}  // namespace colmap_seapoint
