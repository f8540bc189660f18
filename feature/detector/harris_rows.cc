#include "feature/detector/harris_rows.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "feature/kernels/harris_kernels.h"

namespace colmap_seapoint {

namespace {

// Integer Gaussian taps that sum to exactly 256.
std::vector<uint16_t> GaussianTaps(double sigma) {
  if (sigma <= 0) return {256};
  const int radius = static_cast<int>(std::ceil(2.5 * sigma));
  std::vector<double> weights;
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) {
    weights.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += weights.back();
  }
  std::vector<uint16_t> taps;
  int total = 0;
  for (const double weight : weights) {
    taps.push_back(static_cast<uint16_t>(std::lround(256 * weight / sum)));
    total += taps.back();
  }
  taps[static_cast<size_t>(radius)] =
      static_cast<uint16_t>(taps[static_cast<size_t>(radius)] + 256 - total);
  return taps;
}

std::vector<int32_t> TapPairs(const std::vector<uint16_t>& taps) {
  std::vector<int32_t> pairs;
  for (size_t t = 0; t < taps.size(); t += 2) {
    const int32_t second = t + 1 < taps.size() ? taps[t + 1] : 0;
    pairs.push_back(taps[t] | second << 16);
  }
  return pairs;
}

size_t Size(int value) { return static_cast<size_t>(value); }

}  // namespace

int HarrisBorder(const HarrisOptions& options) {
  return static_cast<int>(GaussianTaps(options.smoothing_sigma).size()) / 2 + 1 +
         options.window_size / 2;
}

HarrisRows::HarrisRows(const GrayImage& picture, const HarrisOptions& options, int first_row)
    : picture_(picture),
      taps_(GaussianTaps(options.smoothing_sigma)),
      tap_pairs_(TapPairs(taps_)),
      smoothing_radius_(static_cast<int>(taps_.size()) / 2),
      box_radius_(options.window_size / 2),
      border_(HarrisBorder(options)),
      k_(static_cast<float>(options.k)),
      first_smooth_y_(first_row - box_radius_ - 1),
      first_gradient_y_(first_row - box_radius_),
      next_smooth_y_(first_smooth_y_),
      next_gradient_y_(first_gradient_y_),
      next_y_(first_row),
      sources_(taps_.size()),
      down_(1, Size(picture.width)),
      smooth_(Size(options.window_size) + 3, Size(picture.width)),
      no_row_(1, Size(picture.width)),
      column_sums_(6, Size(picture.width) / 2 + 1) {
  SEAPOINT_CHECK(options.window_size % 2 == 1 && options.window_size <= 11);
  SEAPOINT_CHECK(picture.width > 2 * border_ && picture.height > 2 * border_);
  SEAPOINT_CHECK(first_row >= border_ && first_row < picture.height - border_);
}

void HarrisRows::Next(float* row) {
  SEAPOINT_CHECK(next_y_ < picture_.height - border_);
  while (next_gradient_y_ <= next_y_ + box_radius_) {
    while (next_smooth_y_ <= next_gradient_y_ + 1) Smooth();
    Accumulate();
  }
  float extremes[2] = {lowest_, highest_};
  harris::MeasureRow(column_sums_.Row(0), column_sums_.stride(), box_radius_,
                     Size(picture_.width - 2 * border_), k_, row + border_, extremes);
  lowest_ = extremes[0];
  highest_ = extremes[1];
  ++next_y_;
}

const int16_t* HarrisRows::SmoothRow(int y) const {
  const size_t ring_size = Size(2 * box_radius_ + 4);
  return y < first_smooth_y_ ? no_row_.Row(0) : smooth_.Row(Size(y - first_smooth_y_) % ring_size);
}

void HarrisRows::Smooth() {
  const int y = next_smooth_y_++;
  const int num_taps = static_cast<int>(taps_.size());
  for (int t = 0; t < num_taps; ++t) {
    sources_[Size(t)] = picture_.Row(y + t - smoothing_radius_);
  }
  harris::SmoothDown(sources_.data(), taps_.data(), num_taps, Size(picture_.width), down_.Row(0));
  harris::SmoothAcross(down_.Row(0), tap_pairs_.data(), tap_pairs_.size(),
                       Size(picture_.width - 2 * smoothing_radius_),
                       const_cast<int16_t*>(SmoothRow(y)));
}

void HarrisRows::Accumulate() {
  const int y = next_gradient_y_++;
  const int16_t* const entering[3] = {SmoothRow(y - 1), SmoothRow(y), SmoothRow(y + 1)};
  const int leaving_y = y - 2 * box_radius_ - 1;
  const int16_t* const none = no_row_.Row(0);
  const int16_t* leaving[3] = {none, none, none};
  if (leaving_y >= first_gradient_y_) {
    for (int v = 0; v < 3; ++v) leaving[v] = SmoothRow(leaving_y + v - 1);
  }
  harris::SlideSums(entering, leaving, Size(picture_.width - 2 * smoothing_radius_ - 2),
                    column_sums_.Row(0), column_sums_.stride());
}

}  // namespace colmap_seapoint
