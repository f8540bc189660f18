#include "feature/detector/local_maxima.h"

#include <algorithm>
#include <cstdint>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "feature/detector/harris_rows.h"
#include "feature/detector/padded_rows.h"
#include "feature/kernels/maxima_kernels.h"

namespace colmap_seapoint {

namespace {

struct RowRange {
  int begin, end;
};

size_t Size(int value) { return static_cast<size_t>(value); }

// One band of rows. Measures of row y come out; peaks of their 3 x 3 neighbourhood are found one
// row later; they are held against their whole window as soon as its last row is there.
class MaximaBand {
 public:
  // map_rows: where measures exist. band: whose maxima are wanted.
  MaximaBand(const GrayImage& picture, const GrayImage& mask, const HarrisOptions& options,
             int radius, int border, RowRange map_rows, RowRange band)
      : mask_(mask),
        width_(picture.width),
        radius_(radius),
        border_(border),
        rows_({std::max(map_rows.begin, band.begin - radius),
               std::min(map_rows.end, band.end + radius)}),
        wanted_({std::max(band.begin, border), std::min(band.end, picture.height - border)}),
        harris_(picture, options, rows_.begin),
        ring_(Size(2 * radius + 1), Size(width_ + 2 * radius)),
        no_row_(1, Size(width_ + 2 * radius)),
        peaks_(Size(radius + 1), Size(width_) / 2 + 1),
        num_peaks_(Size(radius + 1)),
        window_(Size(2 * radius + 1)) {}

  LocalMaxima Run() {
    for (int y = rows_.begin; y < rows_.end + radius_; ++y) {
      if (y < rows_.end) harris_.Next(ring_.Row(Size(y) % window_.size()) + radius_);
      if (IsWanted(y - 1)) FindPeaks(y - 1);
      if (IsWanted(y - radius_)) KeepMaxima(y - radius_);
    }
    found_.lowest = harris_.lowest();
    found_.highest = harris_.highest();
    return std::move(found_);
  }

 private:
  bool IsWanted(int y) const { return y >= wanted_.begin && y < wanted_.end; }

  // From column 0 on; zeros where there are no measures.
  const float* Row(int y) const {
    const bool exists = y >= rows_.begin && y < rows_.end;
    return (exists ? ring_.Row(Size(y) % window_.size()) : no_row_.Row(0)) + radius_;
  }

  void FindPeaks(int y) {
    const size_t slot = Size(y) % num_peaks_.size();
    num_peaks_[slot] = maxima::FindPeaks(Row(y - 1), Row(y), Row(y + 1), border_, width_ - border_,
                                         peaks_.Row(slot));
  }

  void KeepMaxima(int y) {
    const size_t slot = Size(y) % num_peaks_.size();
    int32_t* columns = peaks_.Row(slot);
    size_t count = num_peaks_[slot];
    if (!mask_.Empty()) {
      const uint8_t* mask = mask_.Row(y);
      count = Size(static_cast<int>(
          std::remove_if(columns, columns + count, [&](int32_t x) { return mask[x] == 0; }) -
          columns));
    }
    for (int v = -radius_; v <= radius_; ++v) window_[Size(v + radius_)] = Row(y + v);
    count = maxima::KeepGreatest(window_.data(), radius_, columns, count);
    for (size_t i = 0; i < count; ++i) {
      LocalMaximum maximum;
      maximum.x = columns[i];
      maximum.y = y;
      for (int v = 0; v < 3; ++v) {
        const float* row = window_[Size(radius_ - 1 + v)] + maximum.x - 1;
        std::copy(row, row + 3, maximum.around + 3 * v);
      }
      found_.maxima.push_back(maximum);
    }
  }

  const GrayImage& mask_;
  const int width_, radius_, border_;
  const RowRange rows_, wanted_;
  HarrisRows harris_;
  PaddedRows<float> ring_;     // of measures, `radius` zeros before each row
  PaddedRows<float> no_row_;   // zeros
  PaddedRows<int32_t> peaks_;  // ring: columns of the peaks of a row
  std::vector<size_t> num_peaks_;
  std::vector<const float*> window_;
  LocalMaxima found_;
};

}  // namespace

LocalMaxima FindLocalMaxima(const GrayImage& picture, const GrayImage& mask,
                            const HarrisOptions& options, int radius, int border, int num_threads) {
  const int harris_border = HarrisBorder(options);
  SEAPOINT_CHECK(radius >= 1 && border > harris_border);
  if (picture.width <= 2 * harris_border || picture.height <= 2 * harris_border) return {};
  const RowRange map_rows = {harris_border, picture.height - harris_border};
  const int num_rows = map_rows.end - map_rows.begin;
  const int num_bands = std::min(EffectiveNumThreads(num_threads), num_rows);
  std::vector<LocalMaxima> found(Size(num_bands));
  ParallelFor(num_threads, num_bands, [&](int64_t band) {
    auto begin = [&](int64_t b) {
      return map_rows.begin + static_cast<int>(num_rows * b / num_bands);
    };
    found[static_cast<size_t>(band)] =
        MaximaBand(picture, mask, options, radius, border, map_rows, {begin(band), begin(band + 1)})
            .Run();
  });
  LocalMaxima all = std::move(found[0]);
  for (size_t band = 1; band < found.size(); ++band) {
    all.lowest = std::min(all.lowest, found[band].lowest);
    all.highest = std::max(all.highest, found[band].highest);
    all.maxima.insert(all.maxima.end(), found[band].maxima.begin(), found[band].maxima.end());
  }
  return all;
}

}  // namespace colmap_seapoint
