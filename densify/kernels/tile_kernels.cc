#include "densify/kernels/tile_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "densify/kernels/tile_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

// How it works. Picture 2 is warped by the prediction once; from then on a disparity more or less
// is a shift of the warped picture, and every sum over a window is a running sum down the columns,
// then across them. With pixels centred on 0 all sums and products of a window fit 32 bits.

// Shared by all versions.
#ifndef SEAPOINT_TILE_KERNELS_ONCE
#define SEAPOINT_TILE_KERNELS_ONCE
namespace colmap_seapoint {
namespace tile {
namespace {

constexpr int kShifts = 2 * kReach + 1;
constexpr int kMaxHalf = kMaxWindow / 2;
constexpr size_t kFront = 16;  // columns before the first: a shift may read them
// Columns of a tile with its windows and shifts, filled up to whole vectors, and room behind.
constexpr size_t kColumns = 96;
constexpr size_t kStride = kFront + kColumns + 32;
constexpr size_t kRows = kWideHeight + 2 * kMaxHalf;
constexpr int16_t kOutside = -128;  // a pixel that is not there; real ones are -127 .. 127

static_assert(kWideWidth + 2 * (kMaxHalf + kReach) <= kColumns && kWideWidth + 16 <= kRowStride);

constexpr int kPhaseBits = 6;
constexpr int kPhases = 1 << kPhaseBits;  // positions between two pixels

// Catmull-Rom weights of the four pixels around a position, 64 = 1, one signed byte each.
struct CubicTable {
  int32_t packed[kPhases];
  constexpr CubicTable() : packed() {
    for (int p = 0; p < kPhases; ++p) {
      const double t = static_cast<double>(p) / kPhases;
      const double w[4] = {-0.5 * t + t * t - 0.5 * t * t * t, 1 - 2.5 * t * t + 1.5 * t * t * t,
                           0.5 * t + 2 * t * t - 1.5 * t * t * t, -0.5 * t * t + 0.5 * t * t * t};
      int rounded[4] = {}, sum = 0;
      for (int k = 0; k < 4; ++k) {
        const double scaled = 64 * w[k];
        rounded[k] = static_cast<int>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
        sum += rounded[k];
      }
      rounded[p < kPhases / 2 ? 1 : 2] += 64 - sum;
      uint32_t bits = 0;
      for (int k = 3; k >= 0; --k) bits = bits << 8 | static_cast<uint8_t>(rounded[k]);
      packed[p] = static_cast<int32_t>(bits);
    }
  }
};
constexpr CubicTable kCubic;

struct Scratch {
  alignas(64) int16_t left[kRows * kStride];    // picture 1, less 128
  alignas(64) int16_t warped[kRows * kStride];  // picture 2 warped, less 128
  alignas(64) float prediction[kRows * kStride];
  // Running sums down the columns: of left, its squares, warped, its squares, and the products at
  // every shift.
  alignas(64) int32_t column[4 + kShifts][kStride];
  alignas(64) int32_t sum2[kStride];          // of a window of `warped`
  alignas(64) float inverse_spread[kStride];  // 1 / sqrt(n sum of squares - sum^2) of it, or 0
};

}  // namespace
}  // namespace tile
}  // namespace colmap_seapoint
#endif  // SEAPOINT_TILE_KERNELS_ONCE

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace tile {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<DF>;
using D16 = hn::Rebind<int16_t, DI>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;

// What holds for the whole region: its windows with their shifts. Column c of the scratch is pixel
// left + c of the tile, row r its pixel top + r.
struct Frame {
  int half, columns;
  int left, top;
  int left_column, top_row;  // of gray1

  Frame(const Pair& pair, const Region& region)
      : half(pair.window / 2),
        columns(region.width + 2 * (half + kReach)),
        left(region.x0 - half - kReach),
        top(region.y0 - half),
        left_column(region.tile_x + left),
        top_row(region.tile_y + top) {}
};

// The prediction along one row of pixels, `row` of the scratch.
void PredictRow(const Prediction& prediction, const Frame& frame, int row_idx, float* row) {
  const DF df;
  const int step = prediction.node_step, nodes_x = prediction.NodesX();
  const int down = frame.top + row_idx + step / 2;
  const int b = std::clamp(down / step, 0, prediction.NodesY() - 2);
  const float v = static_cast<float>(down - b * step) / static_cast<float>(step);
  const auto& above = prediction.disparity[static_cast<size_t>(b)];
  const auto& below = prediction.disparity[static_cast<size_t>(b) + 1];
  const int lanes = static_cast<int>(hn::Lanes(df));
  const int offset = frame.left + step / 2;  // from the first node to column 0
  float node = above[0] + v * (below[0] - above[0]);
  for (int a = 0; a + 1 < nodes_x; ++a) {
    const size_t right = static_cast<size_t>(a) + 1;
    const float next = above[right] + v * (below[right] - above[right]);
    const VF slope = hn::Set(df, (next - node) / static_cast<float>(step));
    const VF start = hn::Set(df, node);
    node = next;
    const int begin = a == 0 ? 0 : std::max(0, a * step - offset);
    const int end = a + 2 == nodes_x ? frame.columns + lanes : (a + 1) * step - offset;
    for (int c = begin; c < end; c += lanes) {
      const VF t = hn::Add(hn::Iota(df, 0), hn::Set(df, static_cast<float>(c + offset - a * step)));
      hn::StoreU(hn::Add(start, hn::Mul(t, slope)), df, row + c);
    }
  }
}

// Pixels of a row, less 128; pixels that are not there kOutside.
void LoadLeft(const Pair& pair, const Frame& frame, int row, int16_t* to) {
  const int y = frame.top_row + row;
  const GrayImage& gray = *pair.gray1;
  if (y < 0 || y >= gray.height) {
    std::fill_n(to, frame.columns, kOutside);
    return;
  }
  const uint8_t* source = gray.Row(y);
  for (int c = 0; c < frame.columns; ++c) {
    const int x = frame.left_column + c;
    to[c] = x < 0 || x >= gray.width ? kOutside : static_cast<int16_t>(source[x] - 128);
  }
}

HWY_INLINE VI Tap(VI pixels, VI weights, int tap) {
  const DI di;
  const VI pixel = hn::And(hn::ShiftRightSame(pixels, 8 * tap), hn::Set(di, 255));
  const VI weight = hn::ShiftRight<24>(hn::ShiftLeftSame(weights, 24 - 8 * tap));
  return hn::Mul(pixel, weight);
}

HWY_INLINE auto HasZeroByte(VI v) {
  const DI di;
  // Exact for "is there any zero byte".
  const VI borrow = hn::AndNot(v, hn::Sub(v, hn::Set(di, 0x01010101)));
  return hn::Ne(hn::And(borrow, hn::Set(di, static_cast<int32_t>(0x80808080u))), hn::Zero(di));
}

// Picture 2 along the row, at the predicted disparities.
void WarpRow(const Pair& pair, const Frame& frame, int row, const float* prediction, int16_t* to) {
  const DF df;
  const DI di;
  const D16 d16;
  const GrayImage& gray = *pair.gray2;
  const int y = frame.top_row + row + pair.row_shift;
  if (y < 0 || y >= gray.height) {
    std::fill_n(to, frame.columns, kOutside);
    return;
  }
  const uint8_t* source = gray.Row(y);
  const VF origin = hn::Set(df, static_cast<float>(frame.left_column + pair.column_shift));
  // Positions with two pixels on either side: [lowest, end).
  const VF lowest = hn::Set(df, 1.0f), end = hn::Set(df, static_cast<float>(gray.width - 2));
  const VF highest = hn::Sub(end, hn::Set(df, 1.0f / kPhases));
  const VF phases = hn::Set(df, static_cast<float>(kPhases));
  for (int c = 0; c < frame.columns; c += static_cast<int>(hn::Lanes(df))) {
    const VF column = hn::Add(hn::Iota(df, static_cast<float>(c)), origin);
    const VF wanted = hn::Sub(column, hn::LoadU(df, prediction + c));
    const VF at = hn::Min(hn::Max(wanted, lowest), highest);
    const VI fixed = hn::ConvertTo(di, hn::Add(hn::Mul(at, phases), hn::Set(df, 0.5f)));
    const VI first = hn::Sub(hn::ShiftRight<kPhaseBits>(fixed), hn::Set(di, 1));
    const VI phase = hn::And(fixed, hn::Set(di, kPhases - 1));
    const VI pixels = hn::GatherOffset(di, reinterpret_cast<const int32_t*>(source), first);
    const VI weights = hn::GatherIndex(di, kCubic.packed, phase);
    VI value = hn::Add(hn::Add(Tap(pixels, weights, 0), Tap(pixels, weights, 1)),
                       hn::Add(Tap(pixels, weights, 2), Tap(pixels, weights, 3)));
    value = hn::ShiftRight<6>(hn::Add(value, hn::Set(di, 32)));
    value = hn::Min(hn::Max(value, hn::Set(di, 1)), hn::Set(di, 255));
    const auto beyond = hn::RebindMask(di, hn::Or(hn::Lt(wanted, lowest), hn::Ge(wanted, end)));
    value = hn::IfThenZeroElse(hn::Or(HasZeroByte(pixels), beyond), value);
    hn::StoreU(hn::DemoteTo(d16, hn::Sub(value, hn::Set(di, 128))), d16, to + c);
  }
}

HWY_INLINE VI LoadPixels(const int16_t* from) {
  return hn::PromoteTo(DI(), hn::LoadU(D16(), from));
}

// Adds row `entering` to the column sums and takes row `leaving` away, unless that is negative.
template <bool kLeaves>
void MoveDown(const Frame& frame, size_t entering, size_t leaving, Scratch* scratch) {
  const DI di;
  const int16_t* left_in = scratch->left + entering * kStride + kFront;
  const int16_t* left_out = scratch->left + leaving * kStride + kFront;
  const int16_t* warped_in = scratch->warped + entering * kStride + kFront;
  const int16_t* warped_out = scratch->warped + leaving * kStride + kFront;
  for (int c = 0; c < frame.columns; c += static_cast<int>(hn::Lanes(di))) {
    const auto move = [&](size_t quantity, VI in, VI out) HWY_ATTR {
      int32_t* sum = scratch->column[quantity] + kFront + c;
      VI moved = hn::Add(hn::LoadU(di, sum), in);
      if constexpr (kLeaves) moved = hn::Sub(moved, out);
      hn::StoreU(moved, di, sum);
    };
    const VI a = LoadPixels(left_in + c), b = LoadPixels(warped_in + c);
    VI c_out = hn::Zero(di), d_out = c_out;
    if constexpr (kLeaves) {
      c_out = LoadPixels(left_out + c);
      d_out = LoadPixels(warped_out + c);
    }
    move(0, a, c_out);
    move(1, hn::Mul(a, a), hn::Mul(c_out, c_out));
    move(2, b, d_out);
    move(3, hn::Mul(b, b), hn::Mul(d_out, d_out));
    for (int shift = -kReach; shift <= kReach; ++shift) {
      const VI in = hn::Mul(a, LoadPixels(warped_in + c - shift));
      VI out = c_out;
      if constexpr (kLeaves) out = hn::Mul(c_out, LoadPixels(warped_out + c - shift));
      move(static_cast<size_t>(4 + kReach + shift), in, out);
    }
  }
}

// Sum of `window` columns centred on c.
HWY_INLINE VI Across(const int32_t* column, int c, int half) {
  const DI di;
  const int32_t* from = column + kFront + c - half;
  VI sum = hn::LoadU(di, from);
  for (int k = 1; k <= 2 * half; ++k) sum = hn::Add(sum, hn::LoadU(di, from + k));
  return sum;
}

// 1 / sqrt(n squares - sum^2); 0 where the window has no texture or one of its corners is missing.
HWY_INLINE VF InverseSpread(VI sum, VI squares, int window, const int16_t* center_row, int c) {
  const DI di;
  const DF df;
  const int n = window * window, half = window / 2;
  const VI scatter = hn::Sub(hn::Mul(squares, hn::Set(di, n)), hn::Mul(sum, sum));
  const VI outside = hn::Set(di, kOutside);
  auto usable = hn::Gt(scatter, hn::Set(di, n * n - 1));  // at least 1 grey level squared
  for (const int dy : {-half, half}) {
    const int16_t* row = center_row + dy * static_cast<int>(kStride) + c;
    usable = hn::And(usable, hn::Ne(LoadPixels(row - half), outside));
    usable = hn::And(usable, hn::Ne(LoadPixels(row + half), outside));
  }
  const VF spread = hn::Sqrt(hn::ConvertTo(df, scatter));
  return hn::IfThenElseZero(hn::RebindMask(df, usable), hn::Div(hn::Set(df, 1.0f), spread));
}

// Sum and inverse spread of the windows of `warped` along a row, for ScoreRow.
void SpreadRow(const Frame& frame, int window, size_t center, Scratch* scratch) {
  const DI di;
  const DF df;
  const int half = frame.half;
  const int16_t* warped_row = scratch->warped + center * kStride + kFront;
  for (int c = half; c < frame.columns - half; c += static_cast<int>(hn::Lanes(df))) {
    const VI sum = Across(scratch->column[2], c, half);
    hn::StoreU(sum, di, scratch->sum2 + kFront + c);
    hn::StoreU(InverseSpread(sum, Across(scratch->column[3], c, half), window, warped_row, c), df,
               scratch->inverse_spread + kFront + c);
  }
}

// The best of the five scores with its neighbours; score 0 where there is none.
struct Peak {
  VF score, before, after, shift;
};

// Walks along the five scores; a maximum needs both its neighbours, and they must be usable: less
// than `unusable`.
template <typename ScoreAt>
HWY_INLINE Peak FindPeak(const ScoreAt& score_at, VF unusable) {
  const DF df;
  VF before = score_at(-kReach), here = score_at(-kReach + 1);
  const VF zero = hn::Zero(df);
  Peak peak = {zero, zero, zero, zero};
  for (int shift = -kReach + 1; shift < kReach; ++shift) {
    const VF after = score_at(shift + 1);
    const auto usable = hn::And(hn::Gt(here, peak.score), hn::Lt(here, unusable));
    const auto better = hn::And(usable, hn::And(hn::Ge(here, before), hn::Ge(here, after)));
    peak.before = hn::IfThenElse(better, before, peak.before);
    peak.after = hn::IfThenElse(better, after, peak.after);
    peak.shift = hn::IfThenElse(better, hn::Set(df, static_cast<float>(shift)), peak.shift);
    peak.score = hn::IfThenElse(better, here, peak.score);
    before = here;
    here = after;
  }
  return peak;
}

// Scores of one row of windows, centred on row `center` of the scratch.
void ScoreRow(const Pair& pair, const Frame& frame, int width, size_t center, Scratch* scratch,
              const Results& row) {
  const DI di;
  const DF df;
  const int window = pair.window, half = frame.half;
  const int16_t* left_row = scratch->left + center * kStride + kFront;
  const float* predicted = scratch->prediction + center * kStride + kFront;
  SpreadRow(frame, window, center, scratch);
  const VI n = hn::Set(di, window * window);
  const VF unusable = hn::Set(df, 2.0f);
  const VF doubt = hn::Set(df, 2.0f / static_cast<float>(window * window));
  for (int x = 0; x < width; x += static_cast<int>(hn::Lanes(df))) {
    const int c = x + half + kReach;
    const VI sum1 = Across(scratch->column[0], c, half);
    const VF spread1 =
        InverseSpread(sum1, Across(scratch->column[1], c, half), window, left_row, c);
    const auto score_at = [&](int shift) HWY_ATTR {
      const VI products = Across(scratch->column[static_cast<size_t>(4 + kReach + shift)], c, half);
      const VI sum2 = hn::LoadU(di, scratch->sum2 + kFront + c - shift);
      const VI covariance = hn::Sub(hn::Mul(products, n), hn::Mul(sum1, sum2));
      const VF spread2 = hn::LoadU(df, scratch->inverse_spread + kFront + c - shift);
      const VF correlation = hn::Mul(hn::Mul(hn::ConvertTo(df, covariance), spread1), spread2);
      return hn::IfThenElse(hn::Eq(spread2, hn::Zero(df)), unusable, correlation);
    };
    const Peak peak = FindPeak(score_at, unusable);
    // The top of the parabola through the maximum and its neighbours.
    const VF curvature = hn::Sub(hn::Add(peak.before, peak.after), hn::Add(peak.score, peak.score));
    const VF offset =
        hn::Div(hn::Mul(hn::Set(df, 0.5f), hn::Sub(peak.before, peak.after)), curvature);
    const auto found = hn::And(hn::Gt(peak.score, hn::Zero(df)), hn::Lt(curvature, hn::Zero(df)));
    // A shift moves along picture 2, the prediction with it: d = shift + prediction(x - shift).
    const VF slope = hn::Mul(hn::Set(df, 0.5f), hn::Sub(hn::LoadU(df, predicted + c + 1),
                                                        hn::LoadU(df, predicted + c - 1)));
    const VF stretch = hn::Sub(hn::Set(df, 1.0f), slope);
    const VF moved = hn::Mul(hn::Add(peak.shift, offset), stretch);
    const VF variance = hn::Div(hn::Mul(doubt, hn::Sub(peak.score, hn::Set(df, 1.0f))), curvature);
    const VF deviation = hn::Mul(hn::Sqrt(hn::Max(variance, hn::Zero(df))), stretch);
    hn::StoreU(hn::IfThenElseZero(found, moved), df, row.residual + x);
    hn::StoreU(hn::IfThenElseZero(found, peak.score), df, row.score + x);
    hn::StoreU(hn::IfThenElseZero(found, deviation), df, row.deviation + x);
  }
}

void Match(const Pair& pair, const Region& region, const Prediction& prediction,
           const Results& results) {
  const Frame frame(pair, region);
  Scratch scratch;  // what columns beyond the frame hold is never used
  for (auto& sums : scratch.column) std::fill(std::begin(sums), std::end(sums), 0);
  const int lowest_asked =
      region.first_row + (region.height - 1 - region.first_row) / region.row_step * region.row_step;
  const size_t window = static_cast<size_t>(pair.window), half = window / 2;
  size_t filled = 0, out = 0;
  for (int y = region.first_row; y <= lowest_asked; y += region.row_step) {
    const size_t center = static_cast<size_t>(y) + half;
    for (; filled <= center + half; ++filled) {
      const size_t at = filled * kStride + kFront;
      PredictRow(prediction, frame, static_cast<int>(filled), scratch.prediction + at);
      LoadLeft(pair, frame, static_cast<int>(filled), scratch.left + at);
      WarpRow(pair, frame, static_cast<int>(filled), scratch.prediction + at, scratch.warped + at);
      if (filled < window) {
        MoveDown<false>(frame, filled, 0, &scratch);
      } else {
        MoveDown<true>(frame, filled, filled - window, &scratch);
      }
    }
    ScoreRow(pair, frame, region.width, center, &scratch,
             {results.residual + out, results.score + out, results.deviation + out});
    out += kRowStride;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tile
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace tile {

HWY_EXPORT(Match);

float PredictedAt(const Prediction& prediction, int x, int y) {
  const int step = prediction.node_step;
  const int right = x + step / 2, down = y + step / 2;
  const int a = std::clamp(right / step, 0, prediction.NodesX() - 2);
  const int b = std::clamp(down / step, 0, prediction.NodesY() - 2);
  const float u = static_cast<float>(right - a * step) / static_cast<float>(step);
  const float v = static_cast<float>(down - b * step) / static_cast<float>(step);
  const auto& top = prediction.disparity[static_cast<size_t>(b)];
  const auto& bottom = prediction.disparity[static_cast<size_t>(b) + 1];
  const size_t i = static_cast<size_t>(a);
  const float left = top[i] + v * (bottom[i] - top[i]);
  const float next = top[i + 1] + v * (bottom[i + 1] - top[i + 1]);
  return left + u * (next - left);
}

void Match(const Pair& pair, const Region& region, const Prediction& prediction,
           const Results& results) {
  HWY_DYNAMIC_DISPATCH(Match)(pair, region, prediction, results);
}

}  // namespace tile
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
