// Harris measures (paper 2.3) row by row: what a pass over the picture needs at once is a few rows.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "feature/detector/harris_measure.h"
#include "feature/detector/padded_rows.h"

namespace colmap_seapoint {

// Yields the rows first_row, first_row + 1, ... of the map of `picture`, which must outlive it and
// be wider and higher than twice the border. Rows can start anywhere in [border, height - border):
// all sums are integers, so a row has the same bits wherever the pass began. Vector code is chosen
// at run time; every version gives the same bits. Not for two threads at once.
class HarrisRows {
 public:
  HarrisRows(const GrayImage& picture, const HarrisOptions& options, int first_row);

  // Writes columns [border, width - border) of the next row and zeros behind them; `row` has
  // `width` + kRowSlack elements.
  void Next(float* row);

  // Extremes of the rows so far and of the border, which is 0.
  float lowest() const { return lowest_; }
  float highest() const { return highest_; }

 private:
  void Smooth();      // one more smoothed row
  void Accumulate();  // one more row of gradients into the column sums
  const int16_t* SmoothRow(int y) const;

  const GrayImage& picture_;
  const std::vector<uint16_t> taps_;
  const std::vector<int32_t> tap_pairs_;
  const int smoothing_radius_, box_radius_, border_;
  const float k_;
  const int first_smooth_y_, first_gradient_y_;
  int next_smooth_y_, next_gradient_y_, next_y_;
  float lowest_ = 0, highest_ = 0;
  std::vector<const uint8_t*> sources_;  // the picture's rows under the taps
  PaddedRows<int16_t> down_;             // one row, smoothed vertically only
  PaddedRows<int16_t> smooth_;           // ring
  PaddedRows<int16_t> no_row_;           // zeros: what leaves the sums while they fill
  PaddedRows<int32_t> column_sums_;      // xx, xy, yy: even columns, odd columns
};

}  // namespace colmap_seapoint
