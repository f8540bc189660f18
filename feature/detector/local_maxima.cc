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

struct Range {
  int begin, end;
};

size_t Size(int value) { return static_cast<size_t>(value); }

// The rows of measures of a window that slides down the picture.
class MeasureWindow {
 public:
  // rows: that are worked out, the windows' middles being at least `radius` rows inside.
  MeasureWindow(const GrayImage& picture, const HarrisOptions& options, int radius, Range rows)
      : radius_(radius),
        rows_(rows),
        harris_(picture, options, rows.begin),
        ring_(Size(2 * radius + 1), Size(picture.width + 2 * radius)),
        no_row_(1, Size(picture.width + 2 * radius)),
        window_(Size(2 * radius + 1)) {}

  // Works out row y if it is one of `rows`. Rows come in their order.
  void TakeIn(int y) {
    if (Exists(y)) harris_.Next(ring_.Row(Size(y) % window_.size()) + radius_);
  }
  // From column 0 on; zeros where there are no measures. One of the 2 radius + 1 latest rows.
  const float* Row(int y) const {
    return (Exists(y) ? ring_.Row(Size(y) % window_.size()) : no_row_.Row(0)) + radius_;
  }
  // The rows y - radius .. y + radius.
  const float* const* Around(int y) {
    for (int v = -radius_; v <= radius_; ++v) window_[Size(v + radius_)] = Row(y + v);
    return window_.data();
  }

  Range Rows() const { return rows_; }
  float Lowest() const { return harris_.lowest(); }
  float Highest() const { return harris_.highest(); }

 private:
  bool Exists(int y) const { return y >= rows_.begin && y < rows_.end; }

  const int radius_;
  const Range rows_;
  HarrisRows harris_;
  PaddedRows<float> ring_;    // of measures, `radius` zeros before each row
  PaddedRows<float> no_row_;  // zeros
  std::vector<const float*> window_;
};

// Columns of the peaks of the latest rows.
class PeakRows {
 public:
  PeakRows(int num_rows, int width)
      : columns_(Size(num_rows), Size(width) / 2 + 1), counts_(Size(num_rows)) {}

  int32_t* Columns(int y) { return columns_.Row(Size(y) % counts_.size()); }
  size_t& Count(int y) { return counts_[Size(y) % counts_.size()]; }

 private:
  PaddedRows<int32_t> columns_;
  std::vector<size_t> counts_;
};

// One band of rows. Measures of row y come out; peaks of their 3 x 3 neighbourhood are found one
// row later; they are held against their whole window as soon as its last row is there.
class MaximaBand {
 public:
  // map_rows: where measures exist. band: whose maxima are wanted.
  MaximaBand(const GrayImage& picture, const GrayImage& mask, const HarrisOptions& options,
             int radius, int border, Range map_rows, Range band)
      : mask_(mask),
        radius_(radius),
        columns_({border, picture.width - border}),
        wanted_({std::max(band.begin, border), std::min(band.end, picture.height - border)}),
        measures_(picture, options, radius,
                  {std::max(map_rows.begin, band.begin - radius),
                   std::min(map_rows.end, band.end + radius)}),
        peaks_(radius + 1, picture.width) {}

  LocalMaxima Run() {
    const Range rows = measures_.Rows();
    for (int y = rows.begin; y < rows.end + radius_; ++y) {
      measures_.TakeIn(y);
      if (IsWanted(y - 1)) FindPeaks(y - 1);
      if (IsWanted(y - radius_)) KeepMaxima(y - radius_);
    }
    found_.lowest = measures_.Lowest();
    found_.highest = measures_.Highest();
    return std::move(found_);
  }

 private:
  bool IsWanted(int y) const { return y >= wanted_.begin && y < wanted_.end; }

  void FindPeaks(int y) {
    peaks_.Count(y) =
        maxima::FindPeaks(measures_.Row(y - 1), measures_.Row(y), measures_.Row(y + 1),
                          columns_.begin, columns_.end, peaks_.Columns(y));
  }

  void KeepMaxima(int y) {
    int32_t* columns = peaks_.Columns(y);
    size_t count = peaks_.Count(y);
    if (!mask_.Empty()) {
      const uint8_t* mask = mask_.Row(y);
      const auto is_masked = [&](int32_t x) { return mask[x] == 0; };
      count = static_cast<size_t>(std::remove_if(columns, columns + count, is_masked) - columns);
    }
    count = maxima::KeepGreatest(measures_.Around(y), radius_, columns, count);
    for (size_t i = 0; i < count; ++i) {
      LocalMaximum maximum;
      maximum.x = columns[i];
      maximum.y = y;
      for (int v = 0; v < 3; ++v) {
        const float* row = measures_.Row(y - 1 + v) + maximum.x - 1;
        std::copy(row, row + 3, maximum.around + 3 * v);
      }
      found_.maxima.push_back(maximum);
    }
  }

  const GrayImage& mask_;
  const int radius_;
  const Range columns_;  // that are wanted
  const Range wanted_;
  MeasureWindow measures_;
  PeakRows peaks_;
  LocalMaxima found_;
};

}  // namespace

LocalMaxima FindLocalMaxima(const GrayImage& picture, const GrayImage& mask,
                            const HarrisOptions& options, int radius, int border, int num_threads) {
  const int harris_border = HarrisBorder(options);
  SEAPOINT_CHECK(radius >= 1 && border > harris_border);
  if (picture.width <= 2 * harris_border || picture.height <= 2 * harris_border) return {};
  const Range map_rows = {harris_border, picture.height - harris_border};
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
