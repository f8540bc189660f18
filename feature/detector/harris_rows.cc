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

SmoothRows::SmoothRows(const GrayImage& picture, double sigma, int first_y, int num_kept)
    : picture_(picture),
      taps_(GaussianTaps(sigma)),
      tap_pairs_(TapPairs(taps_)),
      first_y_(first_y),
      num_kept_(num_kept),
      next_y_(first_y),
      sources_(taps_.size()),
      down_(1, Size(picture.width)),
      kept_(Size(num_kept), Size(picture.width)) {}

int16_t* SmoothRows::Kept(int y) { return kept_.Row(Size((y - first_y_) % num_kept_)); }

const int16_t* SmoothRows::Row(int y) {
  while (next_y_ <= y) Smooth(next_y_++);
  SEAPOINT_CHECK(y >= first_y_ && y >= next_y_ - num_kept_);
  return Kept(y);
}

void SmoothRows::Smooth(int y) {
  const int num_taps = static_cast<int>(taps_.size());
  for (int t = 0; t < num_taps; ++t) sources_[Size(t)] = picture_.Row(y + t - Radius());
  harris::SmoothDown(sources_.data(), taps_.data(), num_taps, Size(picture_.width), down_.Row(0));
  harris::SmoothAcross(down_.Row(0), tap_pairs_.data(), tap_pairs_.size(), Size(Width()), Kept(y));
}

// The window is window_size rows of gradients; to take one in and let one go, the rows above and
// below them are needed as well.
GradientSums::GradientSums(const GrayImage& picture, const HarrisOptions& options, int first_row)
    : radius_(options.window_size / 2),
      first_y_(first_row - radius_),
      next_y_(first_y_),
      smooth_(picture, options.smoothing_sigma, first_y_ - 1, options.window_size + 3),
      no_row_(1, Size(picture.width)),
      sums_(6, Size(picture.width) / 2 + 1) {}

void GradientSums::MoveTo(int y) {
  while (next_y_ <= y + radius_) TakeIn(next_y_++);
}

void GradientSums::TakeIn(int y) {
  const int leaving_y = y - 2 * radius_ - 1;
  const int16_t* const none = no_row_.Row(0);
  const int16_t* entering[3] = {};
  const int16_t* leaving[3] = {none, none, none};
  for (int v = 2; v >= 0; --v) {  // the lowest row first: it may have to be worked out
    entering[v] = smooth_.Row(y + v - 1);
    if (leaving_y >= first_y_) leaving[v] = smooth_.Row(leaving_y + v - 1);
  }
  harris::SlideSums(entering, leaving, Size(smooth_.Width() - 2), sums_.Row(0), sums_.stride());
}

HarrisRows::HarrisRows(const GrayImage& picture, const HarrisOptions& options, int first_row)
    : width_(picture.width),
      height_(picture.height),
      border_(HarrisBorder(options)),
      radius_(options.window_size / 2),
      k_(static_cast<float>(options.k)),
      next_y_(first_row),
      sums_(picture, options, first_row) {
  SEAPOINT_CHECK(options.window_size % 2 == 1 && options.window_size <= 11);
  SEAPOINT_CHECK(width_ > 2 * border_ && height_ > 2 * border_);
  SEAPOINT_CHECK(first_row >= border_ && first_row < height_ - border_);
}

void HarrisRows::Next(float* row) {
  SEAPOINT_CHECK(next_y_ < height_ - border_);
  sums_.MoveTo(next_y_++);
  float extremes[2] = {lowest_, highest_};
  harris::MeasureRow(sums_.Sums(), sums_.Stride(), radius_, Size(width_ - 2 * border_), k_,
                     row + border_, extremes);
  lowest_ = extremes[0];
  highest_ = extremes[1];
}

}  // namespace colmap_seapoint
