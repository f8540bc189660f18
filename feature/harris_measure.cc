#include "feature/harris_measure.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/vector_clones.h"

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

// One row, horizontally: 8 bits -> 16 bits (8 fractional). out[x] covers x - r .. x + r.
SEAPOINT_VECTOR_CLONES
void SmoothRow(const uint8_t* row, int width, const uint16_t* taps, int num_taps, uint16_t* out) {
  const int radius = num_taps / 2;
  const int end = width - radius;
  for (int x = radius; x < end; ++x) {
    out[x] = static_cast<uint16_t>(taps[0] * row[x - radius]);
  }
  for (int t = 1; t < num_taps; ++t) {
    const uint16_t tap = taps[t];
    const uint8_t* shifted = row + t - radius;
    for (int x = radius; x < end; ++x) out[x] = static_cast<uint16_t>(out[x] + tap * shifted[x]);
  }
}

// Vertically over num_taps rows of SmoothRow: 16 fractional bits -> 4.
SEAPOINT_VECTOR_CLONES
void SmoothColumns(const uint16_t* const* rows, int width, const uint16_t* taps, int num_taps,
                   uint32_t* sums, int16_t* out) {
  for (int x = 0; x < width; ++x) sums[x] = 1u << 11;  // rounding
  for (int t = 0; t < num_taps; ++t) {
    const uint32_t tap = taps[t];
    const uint16_t* row = rows[t];
    for (int x = 0; x < width; ++x) sums[x] += tap * row[x];
  }
  for (int x = 0; x < width; ++x) out[x] = static_cast<int16_t>(sums[x] >> 12);
}

struct ProductRow {
  std::vector<int32_t> xx, xy, yy;
};

// Central differences (unscaled: at most 4080) and their products (at most 2^24).
SEAPOINT_VECTOR_CLONES
void GradientProducts(const int16_t* above, const int16_t* here, const int16_t* below, int width,
                      int32_t* xx, int32_t* xy, int32_t* yy) {
  for (int x = 1; x + 1 < width; ++x) {
    const int32_t gx = here[x + 1] - here[x - 1];
    const int32_t gy = below[x] - above[x];
    xx[x] = gx * gx;
    xy[x] = gx * gy;
    yy[x] = gy * gy;
  }
}

SEAPOINT_VECTOR_CLONES
void SlideColumnSums(const int32_t* entering, const int32_t* leaving, int width, int32_t* sums) {
  for (int x = 0; x < width; ++x) sums[x] += entering[x] - leaving[x];
}

SEAPOINT_VECTOR_CLONES
void BoxSums(const int32_t* column_sums, int width, int radius, int32_t* out) {
  for (int x = radius; x < width - radius; ++x) out[x] = column_sums[x - radius];
  for (int t = 1 - radius; t <= radius; ++t) {
    const int32_t* shifted = column_sums + t;
    for (int x = radius; x < width - radius; ++x) out[x] += shifted[x];
  }
}

SEAPOINT_VECTOR_CLONES
void MeasureRow(const int32_t* xx, const int32_t* xy, const int32_t* yy, int begin, int end,
                float k, float* out) {
  constexpr float kScale = 1.0f / 65536.0f;
  for (int x = begin; x < end; ++x) {
    const float a = static_cast<float>(xx[x]) * kScale;
    const float b = static_cast<float>(xy[x]) * kScale;
    const float c = static_cast<float>(yy[x]) * kScale;
    const float trace = a + c;
    out[x] = (a * c - b * b) - k * (trace * trace);
  }
}

// The rows that are alive at once: rings of smoothed rows, of gradient products, and the sums.
class HarrisStream {
 public:
  HarrisStream(const GrayImage& picture, const HarrisOptions& options)
      : picture_(picture),
        width_(picture.width),
        taps_(GaussianTaps(options.smoothing_sigma)),
        smoothing_radius_(static_cast<int>(taps_.size()) / 2),
        box_radius_(options.window_size / 2),
        k_(static_cast<float>(options.k)),
        horizontal_(taps_.size(), std::vector<uint16_t>(Width())),
        smooth_(3, std::vector<int16_t>(Width())),
        products_(static_cast<size_t>(options.window_size) + 1),
        scratch_(Width()) {
    for (ProductRow& row : products_) {
      row.xx.assign(Width(), 0);
      row.xy.assign(Width(), 0);
      row.yy.assign(Width(), 0);
    }
    for (auto* sums : {&column_xx_, &column_xy_, &column_yy_, &box_xx_, &box_xy_, &box_yy_}) {
      sums->assign(Width(), 0);
    }
  }

  void Run(FloatImage* map) {
    for (int y = 0; y < picture_.height; ++y) {
      std::vector<uint16_t>& row = horizontal_[static_cast<size_t>(y) % horizontal_.size()];
      SmoothRow(picture_.Row(y), width_, taps_.data(), static_cast<int>(taps_.size()), row.data());
      const int smooth_y = y - smoothing_radius_;
      if (smooth_y < smoothing_radius_) continue;
      Smooth(smooth_y);
      const int gradient_y = smooth_y - 1;
      if (gradient_y < smoothing_radius_ + 1) continue;
      Accumulate(gradient_y);
      const int measure_y = gradient_y - box_radius_;
      if (measure_y < smoothing_radius_ + 1 + box_radius_) continue;
      Measure(map->Row(measure_y));
    }
  }

 private:
  size_t Width() const { return static_cast<size_t>(width_); }

  void Smooth(int y) {
    std::vector<const uint16_t*> rows;
    for (int t = -smoothing_radius_; t <= smoothing_radius_; ++t) {
      rows.push_back(horizontal_[static_cast<size_t>(y + t) % horizontal_.size()].data());
    }
    SmoothColumns(rows.data(), width_, taps_.data(), static_cast<int>(taps_.size()),
                  scratch_.data(), smooth_[static_cast<size_t>(y) % 3].data());
  }

  void Accumulate(int y) {
    const size_t num_rows = products_.size();
    ProductRow& entering = products_[static_cast<size_t>(y) % num_rows];
    const int begin = smoothing_radius_;
    const int count = width_ - 2 * smoothing_radius_;
    GradientProducts(smooth_[static_cast<size_t>(y - 1) % 3].data() + begin,
                     smooth_[static_cast<size_t>(y) % 3].data() + begin,
                     smooth_[static_cast<size_t>(y + 1) % 3].data() + begin, count,
                     entering.xx.data() + begin, entering.xy.data() + begin,
                     entering.yy.data() + begin);
    // The ring is one row longer than the window: the next slot holds the row that leaves.
    const ProductRow& leaving = products_[static_cast<size_t>(y + 1) % num_rows];
    SlideColumnSums(entering.xx.data(), leaving.xx.data(), width_, column_xx_.data());
    SlideColumnSums(entering.xy.data(), leaving.xy.data(), width_, column_xy_.data());
    SlideColumnSums(entering.yy.data(), leaving.yy.data(), width_, column_yy_.data());
  }

  void Measure(float* out) {
    const int border = smoothing_radius_ + 1 + box_radius_;
    BoxSums(column_xx_.data(), width_, box_radius_, box_xx_.data());
    BoxSums(column_xy_.data(), width_, box_radius_, box_xy_.data());
    BoxSums(column_yy_.data(), width_, box_radius_, box_yy_.data());
    MeasureRow(box_xx_.data(), box_xy_.data(), box_yy_.data(), border, width_ - border, k_, out);
  }

  const GrayImage& picture_;
  const int width_;
  const std::vector<uint16_t> taps_;
  const int smoothing_radius_, box_radius_;
  const float k_;
  std::vector<std::vector<uint16_t>> horizontal_;
  std::vector<std::vector<int16_t>> smooth_;
  std::vector<ProductRow> products_;
  std::vector<int32_t> column_xx_, column_xy_, column_yy_, box_xx_, box_xy_, box_yy_;
  std::vector<uint32_t> scratch_;
};

}  // namespace

int HarrisBorder(const HarrisOptions& options) {
  return static_cast<int>(GaussianTaps(options.smoothing_sigma).size()) / 2 + 1 +
         options.window_size / 2;
}

FloatImage HarrisMeasure(const GrayImage& picture, const HarrisOptions& options) {
  SEAPOINT_CHECK(options.window_size % 2 == 1 && options.window_size <= 11);
  FloatImage map(picture.width, picture.height);
  const int border = HarrisBorder(options);
  if (picture.width <= 2 * border || picture.height <= 2 * border) return map;
  HarrisStream(picture, options).Run(&map);
  return map;
}

}  // namespace colmap_seapoint
