// Pictures drawn into the rectified frame of their pair, so that matches lie on the same row
// (ours). Lens distortion is taken out on the way.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "densify/match/pair_geometry.h"
#include "densify/match/sample_grid.h"

namespace colmap_seapoint {

// The smallest window that holds the picture's part of the rect frame; without what lies nearer to
// the baseline than 6 degrees, where hardly any pair has a parallax: that is left to other pairs.
RectWindow WindowOfPicture(const PairGeometry& geometry, bool second);

// The blocks of a window that are wanted: what is asked for of a large window is often little.
class BlockMask {
 public:
  static constexpr int kWidth = 64, kHeight = 16;  // pixels

  explicit BlockMask(const RectWindow& window);
  // The blocks that hold a pixel x0 <= x < x1, y0 <= y < y1 of the window.
  void Want(int x0, int y0, int x1, int y1);
  bool Wanted(int column, int row) const {
    return wanted_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                   static_cast<size_t>(column)] != 0;
  }
  int Columns() const { return columns_; }
  int Rows() const { return rows_; }

 private:
  int columns_, rows_;
  std::vector<uint8_t> wanted_;
};

struct RectPicture {
  RectWindow window;
  GrayImage
      gray;  // as large as the window; 0 outside the picture and where not wanted, else 1..255

  // Bytes behind the last pixel that may be read (vectors reach beyond a window).
  static constexpr size_t kSlack = 16;
};

// Where the pixels of a window come from: positions in the source picture, sampled every kCell
// pixels and bilinear in between.
class RectMap {
 public:
  static constexpr size_t kRowSlack = 16;

  RectMap(const PairGeometry& geometry, bool second, const RectWindow& window, int num_threads);
  // Source position (pixels) of the window's pixel (i, j); nullopt outside the picture.
  std::optional<Eigen::Vector2f> Source(int i, int j) const;
  // The same for the pixels begin .. end - 1 of row j, begin a multiple of 8: NaN or beyond the
  // picture where there is none; x and y, from pixel begin on, have room for kRowSlack more.
  void SourceRow(int j, int begin, int end, float* x, float* y) const;
  // Bilinear. Rows are spread over threads.
  RectPicture Rectify(const GrayImage& source, const BlockMask& blocks, int num_threads) const;

 private:
  RectWindow window_;
  int source_width_, source_height_;
  int nodes_x_, nodes_y_;
  std::vector<Eigen::Vector2f> nodes_;  // NaN where there is no projection
};

}  // namespace colmap_seapoint
