#include "feature/kernels/harris_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "feature/kernels/harris_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace harris {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

// These run on machines without vector code, and the vector code must equal them.
void SmoothDown(const uint8_t* const* rows, const uint16_t* taps, int num_taps, size_t width,
                int16_t* out) {
  for (size_t x = 0; x < width; ++x) {
    int sum = -(1 << 15);
    for (int t = 0; t < num_taps; ++t) sum += taps[t] * rows[t][x];
    out[x] = static_cast<int16_t>(sum);
  }
}

void SmoothAcross(const int16_t* in, const int32_t* tap_pairs, size_t num_pairs, size_t width,
                  int16_t* out) {
  for (size_t x = 0; x < width; ++x) {
    int32_t sum = (1 << 23) + (1 << 11);  // the 2^15 taken off, and rounding
    for (size_t t = 0; t < num_pairs; ++t) {
      sum += (tap_pairs[t] & 0xFFFF) * in[x + 2 * t] + (tap_pairs[t] >> 16) * in[x + 2 * t + 1];
    }
    out[x] = static_cast<int16_t>(sum >> 12);
  }
}

void SlideSums(const int16_t* const* entering, const int16_t* const* leaving, size_t width,
               int32_t* sums, size_t stride) {
  for (size_t x = 0; x < width; ++x) {
    const int32_t gx = entering[1][x + 2] - entering[1][x];
    const int32_t gy = entering[2][x + 1] - entering[0][x + 1];
    const int32_t hx = leaving[1][x + 2] - leaving[1][x];
    const int32_t hy = leaving[2][x + 1] - leaving[0][x + 1];
    int32_t* at = sums + x % 2 * stride + x / 2;
    at[0] += gx * gx - hx * hx;
    at[2 * stride] += gx * gy - hx * hy;
    at[4 * stride] += gy * gy - hy * hy;
  }
}

void MeasureRow(const int32_t* sums, size_t stride, int radius, size_t width, float k, float* out,
                float* extremes) {
  constexpr float kScale = 1.0f / 65536.0f;
  for (size_t x = 0; x < width; ++x) {
    int32_t box[3] = {0, 0, 0};
    for (size_t u = x; u <= x + 2 * static_cast<size_t>(radius); ++u) {
      const int32_t* at = sums + u % 2 * stride + u / 2;
      for (size_t i = 0; i < 3; ++i) box[i] += at[2 * i * stride];
    }
    const float a = static_cast<float>(box[0]) * kScale;
    const float b = static_cast<float>(box[1]) * kScale;
    const float c = static_cast<float>(box[2]) * kScale;
    const float trace = a + c;
    out[x] = (a * c - b * b) - k * (trace * trace);
    extremes[0] = HWY_MIN(extremes[0], out[x]);
    extremes[1] = HWY_MAX(extremes[1], out[x]);
  }
}

#else

// The weighted sum of num_taps rows of the picture. The taps are symmetric.
template <class D>
HWY_INLINE hn::Vec<D> WeightedSum(D d16, const uint8_t* const* rows, const uint16_t* taps,
                                  int num_taps, size_t x) {
  const hn::Rebind<uint8_t, D> d8;
  const int radius = num_taps / 2;
  auto sum =
      hn::Mul(hn::PromoteTo(d16, hn::LoadU(d8, rows[radius] + x)), hn::Set(d16, taps[radius]));
  for (int t = 0; t < radius; ++t) {
    const auto pair = hn::Add(hn::PromoteTo(d16, hn::LoadU(d8, rows[t] + x)),
                              hn::PromoteTo(d16, hn::LoadU(d8, rows[num_taps - 1 - t] + x)));
    sum = hn::Add(sum, hn::Mul(pair, hn::Set(d16, taps[t])));
  }
  return hn::Xor(sum, hn::Set(d16, uint16_t{0x8000}));  // less 2^15
}

void SmoothDown(const uint8_t* const* rows, const uint16_t* taps, int num_taps, size_t width,
                int16_t* out) {
  const hn::ScalableTag<int16_t> di16;
  const hn::RebindToUnsigned<decltype(di16)> d16;
  const size_t num_lanes = hn::Lanes(d16);
  if (width < num_lanes) {
    for (size_t x = 0; x < width; ++x) {
      int sum = -(1 << 15);
      for (int t = 0; t < num_taps; ++t) sum += taps[t] * rows[t][x];
      out[x] = static_cast<int16_t>(sum);
    }
    return;
  }
  for (size_t x = 0;; x += num_lanes) {
    // The picture has no slack behind its rows: the last vector overlaps the one before.
    x = HWY_MIN(x, width - num_lanes);
    hn::StoreU(hn::BitCast(di16, WeightedSum(d16, rows, taps, num_taps, x)), di16, out + x);
    if (x + num_lanes == width) break;
  }
}

// out[x] = rounded weighted sum of in[x] .. in[x + 2 radius]. tap_pairs: two taps in an int32, the
// last one filled up with a tap of 0.
void SmoothAcross(const int16_t* HWY_RESTRICT in, const int32_t* HWY_RESTRICT tap_pairs,
                  size_t num_pairs, size_t width, int16_t* HWY_RESTRICT out) {
  const hn::ScalableTag<int16_t> d16;
  const hn::RepartitionToWide<decltype(d16)> d32;
  const auto offset = hn::Set(d32, (1 << 23) + (1 << 11));  // the 2^15 taken off, and rounding
  for (size_t x = 0; x < width; x += hn::Lanes(d16)) {
    auto even = offset, odd = offset;
    auto even_rest = hn::Zero(d32), odd_rest = hn::Zero(d32);
    for (size_t t = 0; t < num_pairs; ++t) {
      const auto pair = hn::BitCast(d16, hn::Set(d32, tap_pairs[t]));
      const int16_t* at = in + x + 2 * t;
      even = hn::ReorderWidenMulAccumulate(d32, hn::LoadU(d16, at), pair, even, even_rest);
      odd = hn::ReorderWidenMulAccumulate(d32, hn::LoadU(d16, at + 1), pair, odd, odd_rest);
    }
    even = hn::ShiftRight<12>(hn::RearrangeToOddPlusEven(even, even_rest));
    odd = hn::ShiftLeft<4>(hn::RearrangeToOddPlusEven(odd, odd_rest));
    hn::StoreU(hn::OddEven(hn::BitCast(d16, odd), hn::BitCast(d16, even)), d16, out + x);
  }
}

// Sums of the products of two neighbouring lanes each.
template <class D32, class V16>
HWY_INLINE hn::Vec<D32> PairDot(D32 d32, V16 a, V16 b, hn::Vec<D32> plus) {
  auto rest = hn::Zero(d32);
  const auto sum = hn::ReorderWidenMulAccumulate(d32, a, b, plus, rest);
  return hn::RearrangeToOddPlusEven(sum, rest);
}

// Adds one row's gradient products to the column sums and takes another's away. Rows: the smoothed
// ones above, at and below each. sums: xx, xy, yy, each `stride` apart; even columns, then odd.
void SlideSums(const int16_t* const* entering, const int16_t* const* leaving, size_t width,
               int32_t* HWY_RESTRICT sums, size_t stride) {
  const hn::ScalableTag<int16_t> d16;
  const hn::RepartitionToWide<decltype(d16)> d32;
  const auto zero = hn::Zero(d16);
  for (size_t x = 0, half = 0; x < width; x += hn::Lanes(d16), half += hn::Lanes(d32)) {
    const auto gx = hn::Sub(hn::LoadU(d16, entering[1] + x + 2), hn::LoadU(d16, entering[1] + x));
    const auto gy =
        hn::Sub(hn::LoadU(d16, entering[2] + x + 1), hn::LoadU(d16, entering[0] + x + 1));
    const auto hx = hn::Sub(hn::LoadU(d16, leaving[1] + x + 2), hn::LoadU(d16, leaving[1] + x));
    const auto hy = hn::Sub(hn::LoadU(d16, leaving[2] + x + 1), hn::LoadU(d16, leaving[0] + x + 1));
    const auto minus_hx = hn::Sub(zero, hx), minus_hy = hn::Sub(zero, hy);
    // Pairs of lanes (entering, leaving): their dot product is what a column gains.
    for (size_t parity = 0; parity < 2; ++parity) {
      int32_t* at = sums + parity * stride + half;
      const auto pair = [&](auto enter, auto leave) HWY_ATTR {
        return parity == 0
                   ? hn::OddEven(hn::BitCast(d16, hn::ShiftLeft<16>(hn::BitCast(d32, leave))),
                                 enter)
                   : hn::OddEven(leave,
                                 hn::BitCast(d16, hn::ShiftRight<16>(hn::BitCast(d32, enter))));
      };
      const auto px = pair(gx, hx), qx = pair(gx, minus_hx);
      const auto py = pair(gy, hy), qy = pair(gy, minus_hy);
      hn::StoreU(PairDot(d32, px, qx, hn::LoadU(d32, at)), d32, at);
      hn::StoreU(PairDot(d32, px, qy, hn::LoadU(d32, at + 2 * stride)), d32, at + 2 * stride);
      hn::StoreU(PairDot(d32, py, qy, hn::LoadU(d32, at + 4 * stride)), d32, at + 4 * stride);
    }
  }
}

// Sums over 2 radius + 1 columns from 2 i (even) and from 2 i + 1 (odd) on.
template <class D>
HWY_INLINE void BoxSums(D d32, const int32_t* even_columns, const int32_t* odd_columns, int radius,
                        hn::Vec<D>* even, hn::Vec<D>* odd) {
  auto common = hn::Add(hn::LoadU(d32, odd_columns), hn::LoadU(d32, even_columns + radius));
  for (int t = 1; t < radius; ++t) {
    common =
        hn::Add(common, hn::Add(hn::LoadU(d32, even_columns + t), hn::LoadU(d32, odd_columns + t)));
  }
  *even = hn::Add(common, hn::LoadU(d32, even_columns));
  *odd = hn::Add(common, hn::LoadU(d32, odd_columns + radius));
}

// No fused multiply-add here: the bits must be the same on every machine.
template <class D>
HWY_INLINE hn::Vec<D> Measure(D df, hn::Vec<hn::RebindToSigned<D> > xx,
                              hn::Vec<hn::RebindToSigned<D> > xy,
                              hn::Vec<hn::RebindToSigned<D> > yy, float k) {
  const auto scale = hn::Set(df, 1.0f / 65536.0f);
  const auto a = hn::Mul(hn::ConvertTo(df, xx), scale);
  const auto b = hn::Mul(hn::ConvertTo(df, xy), scale);
  const auto c = hn::Mul(hn::ConvertTo(df, yy), scale);
  const auto trace = hn::Add(a, c);
  return hn::Sub(hn::Sub(hn::Mul(a, c), hn::Mul(b, b)),
                 hn::Mul(hn::Set(df, k), hn::Mul(trace, trace)));
}

// width measures from the column sums, zeros behind them; extremes: lowest, highest so far.
void MeasureRow(const int32_t* HWY_RESTRICT sums, size_t stride, int radius, size_t width, float k,
                float* HWY_RESTRICT out, float* HWY_RESTRICT extremes) {
  const hn::ScalableTag<float> df;
  const hn::RebindToSigned<decltype(df)> d32;
  const size_t num_lanes = hn::Lanes(df);
  auto lowest = hn::Set(df, extremes[0]), highest = hn::Set(df, extremes[1]);
  for (size_t x = 0, half = 0; x < width; x += 2 * num_lanes, half += num_lanes) {
    const int32_t* at = sums + half;
    hn::Vec<decltype(d32)> xx0, xx1, xy0, xy1, yy0, yy1;
    BoxSums(d32, at, at + stride, radius, &xx0, &xx1);
    BoxSums(d32, at + 2 * stride, at + 3 * stride, radius, &xy0, &xy1);
    BoxSums(d32, at + 4 * stride, at + 5 * stride, radius, &yy0, &yy1);
    const auto even = Measure(df, xx0, xy0, yy0, k), odd = Measure(df, xx1, xy1, yy1, k);
    hn::StoreInterleaved2(even, odd, df, out + x);
    if (x + 2 * num_lanes <= width) {
      lowest = hn::Min(lowest, hn::Min(even, odd));
      highest = hn::Max(highest, hn::Max(even, odd));
    }
  }
  const size_t rest = width % (2 * num_lanes);
  for (size_t x = width - rest; x < width; ++x) {
    extremes[0] = HWY_MIN(extremes[0], out[x]);
    extremes[1] = HWY_MAX(extremes[1], out[x]);
  }
  for (size_t x = width; x < width - rest + 2 * num_lanes; ++x) out[x] = 0;
  extremes[0] = HWY_MIN(extremes[0], hn::GetLane(hn::MinOfLanes(df, lowest)));
  extremes[1] = HWY_MAX(extremes[1], hn::GetLane(hn::MaxOfLanes(df, highest)));
}

#endif  // HWY_TARGET

}  // namespace HWY_NAMESPACE
}  // namespace harris
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace harris {

HWY_EXPORT(SmoothDown);
HWY_EXPORT(SmoothAcross);
HWY_EXPORT(SlideSums);
HWY_EXPORT(MeasureRow);

void SmoothDown(const uint8_t* const* rows, const uint16_t* taps, int num_taps, size_t width,
                int16_t* out) {
  HWY_DYNAMIC_DISPATCH(SmoothDown)(rows, taps, num_taps, width, out);
}

void SmoothAcross(const int16_t* in, const int32_t* tap_pairs, size_t num_pairs, size_t width,
                  int16_t* out) {
  HWY_DYNAMIC_DISPATCH(SmoothAcross)(in, tap_pairs, num_pairs, width, out);
}

void SlideSums(const int16_t* const* entering, const int16_t* const* leaving, size_t width,
               int32_t* sums, size_t stride) {
  HWY_DYNAMIC_DISPATCH(SlideSums)(entering, leaving, width, sums, stride);
}

void MeasureRow(const int32_t* sums, size_t stride, int radius, size_t width, float k, float* out,
                float* extremes) {
  HWY_DYNAMIC_DISPATCH(MeasureRow)(sums, stride, radius, width, k, out, extremes);
}

}  // namespace harris
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
