// Harris measures (paper 2.3) row by row: what a pass over the picture needs at once is a few rows.
// Three parts, each handing its rows to the next: smoothed grey levels, sums of gradient products
// down the columns, measures.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "feature/detector/harris_measure.h"
#include "feature/detector/padded_rows.h"

namespace colmap_seapoint {

// The picture under a Gaussian, of which the latest `num_kept` rows are kept. `picture` must
// outlive it.
class SmoothRows {
 public:
  SmoothRows(const GrayImage& picture, double sigma, int first_y, int num_kept);

  int Radius() const { return static_cast<int>(taps_.size()) / 2; }
  int Width() const { return picture_.width - 2 * Radius(); }  // of a row, pixels

  // Row y, from the first column that the Gaussian reaches on: one of the num_kept latest. Rows
  // that do not exist yet are worked out.
  const int16_t* Row(int y);

 private:
  void Smooth(int y);
  int16_t* Kept(int y);

  const GrayImage& picture_;
  const std::vector<uint16_t> taps_;  // of the Gaussian; they sum to 256
  const std::vector<int32_t> tap_pairs_;
  const int first_y_, num_kept_;
  int next_y_;
  std::vector<const uint8_t*> sources_;  // the picture's rows under the taps
  PaddedRows<int16_t> down_;             // one row, smoothed vertically only
  PaddedRows<int16_t> kept_;             // ring
};

// Sums of the gradient products xx, xy and yy over window_size rows, column by column: they slide
// down the picture.
class GradientSums {
 public:
  // first_row: the middle of the first window.
  GradientSums(const GrayImage& picture, const HarrisOptions& options, int first_row);

  // Moves the window so that its middle is row `y`. Rows come in their order.
  void MoveTo(int y);

  const int32_t* Sums() const { return sums_.Row(0); }  // xx, xy, yy: even columns, odd columns
  size_t Stride() const { return sums_.stride(); }

 private:
  void TakeIn(int y);  // one more row of gradients; the one that leaves the window goes

  const int radius_;  // of the window
  const int first_y_;
  int next_y_;  // rows of gradients
  SmoothRows smooth_;
  PaddedRows<int16_t> no_row_;  // zeros: what leaves the sums while they fill
  PaddedRows<int32_t> sums_;
};

// Yields the rows first_row, first_row + 1, ... of the map of `picture`, which must outlive it and
// be wider and higher than twice the border. Rows can start anywhere in [border, height - border):
// all sums are whole numbers, so a row has the same bits wherever the pass began. Vector code is
// chosen at run time; every version gives the same bits. Not for two threads at once.
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
  const int width_, height_, border_;
  const int radius_;  // of the window
  const float k_;
  int next_y_;
  GradientSums sums_;
  float lowest_ = 0, highest_ = 0;
};

}  // namespace colmap_seapoint
