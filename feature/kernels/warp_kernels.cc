#include "feature/kernels/warp_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "feature/kernels/warp_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace warp {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, 8>;  // divides every row
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;

// The four weights of Keys' cubic at a fraction of a pixel behind the second.
struct Weights {
  VF w0, w1, w2, w3;
};

HWY_INLINE Weights CubicWeights(VF t) {
  const DF df;
  const VF half = hn::Set(df, 0.5f), one = hn::Set(df, 1.0f), two = hn::Set(df, 2.0f);
  const VF t2 = hn::Mul(t, t), t3 = hn::Mul(t2, t);
  const VF w0 = hn::Mul(half, hn::Sub(hn::Sub(hn::Mul(two, t2), t3), t));
  const VF w3 = hn::Mul(half, hn::Sub(t3, t2));
  const VF w1 =
      hn::Add(one, hn::Sub(hn::Mul(hn::Set(df, 1.5f), t3), hn::Mul(hn::Set(df, 2.5f), t2)));
  // All four add up to one.
  return {w0, w1, hn::Sub(one, hn::Add(w0, hn::Add(w1, w3))), w3};
}

// Four pixels next to each other in one number, the first in its lowest byte.
HWY_INLINE VF MixAcross(VI four, const Weights& w) {
  const DF df;
  const VI byte = hn::Set(DI(), 255);
  const VF p0 = hn::ConvertTo(df, hn::And(four, byte));
  const VF p1 = hn::ConvertTo(df, hn::And(hn::ShiftRight<8>(four), byte));
  const VF p2 = hn::ConvertTo(df, hn::And(hn::ShiftRight<16>(four), byte));
  const VF p3 = hn::ConvertTo(df, hn::And(hn::ShiftRight<24>(four), byte));
  return hn::Add(hn::Add(hn::Mul(w.w0, p0), hn::Mul(w.w1, p1)),
                 hn::Add(hn::Mul(w.w2, p2), hn::Mul(w.w3, p3)));
}

// Samples at positions counted from `origin`, none of them negative.
HWY_INLINE VF SampleAt(const uint8_t* origin, int width, VF x, VF y) {
  const DF df;
  const DI di;
  const VI column = hn::ConvertTo(di, x), row = hn::ConvertTo(di, y);
  const Weights across = CubicWeights(hn::Sub(x, hn::ConvertTo(df, column)));
  const Weights down = CubicWeights(hn::Sub(y, hn::ConvertTo(df, row)));
  const VI at = hn::Add(hn::Mul(row, hn::Set(di, width)), column);
  const auto mix = [&](int line) HWY_ATTR {
    const auto* first = reinterpret_cast<const int32_t*>(origin + (line - 1) * width - 1);
    return MixAcross(hn::GatherOffset(di, first, at), across);
  };
  return hn::Add(hn::Add(hn::Mul(down.w0, mix(0)), hn::Mul(down.w1, mix(1))),
                 hn::Add(hn::Mul(down.w2, mix(2)), hn::Mul(down.w3, mix(3))));
}

// `origin` is the pixel that `placement` counts from.
void SampleFrom(const uint8_t* origin, int width, const Placement& placement, int reach,
                float* HWY_RESTRICT out) {
  const DF df;
  const VF x_across = hn::Set(df, placement.x_across), y_across = hn::Set(df, placement.y_across);
  const auto x = static_cast<float>(placement.x), y = static_cast<float>(placement.y);
  for (int j = -reach; j <= reach; ++j) {
    const auto down = static_cast<float>(j);
    const VF x_row = hn::Set(df, x + down * placement.x_down);
    const VF y_row = hn::Set(df, y + down * placement.y_down);
    for (int i = -reach; i <= reach + 1; i += static_cast<int>(hn::Lanes(df))) {
      const VF across = hn::Iota(df, static_cast<float>(i));
      const VF sample = SampleAt(origin, width, hn::Add(x_row, hn::Mul(across, x_across)),
                                 hn::Add(y_row, hn::Mul(across, y_across)));
      hn::StoreU(sample, df, out);
      out += hn::Lanes(df);
    }
  }
}

// Plain loops from here on: compiled for each target, they become as good as vectors written by
// hand, and the order of the additions is written down.

HWY_INLINE ShiftSums SumShift(const WholePatch& patch, const int16_t* HWY_RESTRICT window) {
  constexpr int kWidth = 2 * kReach + 1;
  ShiftSums sums;
  const int16_t* HWY_RESTRICT p = patch.data();
  for (int j = 0; j < kWidth; ++j, p += Stride(kReach), window += Stride(kWideReach)) {
    for (int i = 0; i < Stride(kReach); ++i) {
      const int32_t other = i < kWidth ? window[i] : 0;
      sums.other += other;
      sums.other_other += other * other;
      sums.patch_other += p[i] * other;
    }
  }
  return sums;
}

void SumShifts(const WholePatch& patch, const WholeWindow& window,
               std::array<ShiftSums, kShifts * kShifts>* sums) {
  for (int y = 0; y < kShifts; ++y) {
    for (int x = 0; x < kShifts; ++x) {
      (*sums)[static_cast<size_t>(y * kShifts + x)] =
          SumShift(patch, window.data() + y * Stride(kWideReach) + x);
    }
  }
}

double Dot(const Patch& a, const Patch& b) {
  constexpr size_t kLanes = 16;
  std::array<float, kLanes> lanes = {};
  for (size_t i = 0; i < a.size(); i += kLanes) {
    for (size_t k = 0; k < kLanes; ++k) lanes[k] += a[i + k] * b[i + k];
  }
  double sum = 0;
  for (const float lane : lanes) sum += static_cast<double>(lane);
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace warp
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace warp {

HWY_EXPORT(SampleFrom);
HWY_EXPORT(SumShifts);
HWY_EXPORT(Dot);

bool IsInside(const GrayImage& picture, const Placement& placement, int reach) {
  const auto extent = [&](float across, float down) {  // the last column lies one further
    return (reach + 1) * std::abs(static_cast<double>(across)) +
           reach * std::abs(static_cast<double>(down));
  };
  const double dx = extent(placement.x_across, placement.x_down);
  const double dy = extent(placement.y_across, placement.y_down);
  // One pixel before and two behind take part; the rest is for rounding.
  constexpr double kBefore = 1.01, kBehind = 2.01;
  return placement.x - dx >= kBefore && placement.y - dy >= kBefore &&
         placement.x + dx <= picture.width - 1 - kBehind &&
         placement.y + dy <= picture.height - 1 - kBehind;
}

void SampleWindow(const GrayImage& picture, const Placement& placement, int reach, float* out) {
  // Positions are counted from a pixel nearby, so that 24 bits hold them to a ten thousandth.
  Placement nearby = placement;
  const int left = static_cast<int>(
      placement.x - (reach + 1) * static_cast<double>(std::abs(placement.x_across)) -
      reach * static_cast<double>(std::abs(placement.x_down)));
  const int top = static_cast<int>(placement.y -
                                   (reach + 1) * static_cast<double>(std::abs(placement.y_across)) -
                                   reach * static_cast<double>(std::abs(placement.y_down)));
  nearby.x -= left;
  nearby.y -= top;
  HWY_DYNAMIC_DISPATCH(SampleFrom)(picture.Row(top) + left, picture.width, nearby, reach, out);
}

void SumShifts(const WholePatch& patch, const WholeWindow& window,
               std::array<ShiftSums, kShifts * kShifts>* sums) {
  HWY_DYNAMIC_DISPATCH(SumShifts)(patch, window, sums);
}

double Dot(const Patch& a, const Patch& b) { return HWY_DYNAMIC_DISPATCH(Dot)(a, b); }

}  // namespace warp
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
