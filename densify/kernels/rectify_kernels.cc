#include "densify/kernels/rectify_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "densify/kernels/rectify_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace rectify {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, kSlack>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;

void InterpolateRow(const float* above, const float* below, float v, int width, float* x,
                    float* y) {
  const DF df;
  const int lanes = static_cast<int>(hn::Lanes(df));
  const auto node = [&](int idx) { return above[idx] + v * (below[idx] - above[idx]); };
  for (int begin = 0; begin < width; begin += kCell) {
    const int a = begin / kCell;
    const float left[2] = {node(2 * a), node(2 * a + 1)};
    const VF step_x = hn::Set(df, (node(2 * a + 2) - left[0]) / kCell);
    const VF step_y = hn::Set(df, (node(2 * a + 3) - left[1]) / kCell);
    for (int i = 0; i < kCell; i += lanes) {  // more lanes than a cell: the next one overwrites
      const VF t = hn::Iota(df, static_cast<float>(i));
      hn::StoreU(hn::Add(hn::Set(df, left[0]), hn::Mul(t, step_x)), df, x + begin + i);
      hn::StoreU(hn::Add(hn::Set(df, left[1]), hn::Mul(t, step_y)), df, y + begin + i);
    }
  }
}

// The two bytes from each position on, as (first, second). Reads nothing behind the last pixel.
struct Bytes {
  VI first, second;
};

HWY_INLINE Bytes GatherTwo(const uint8_t* data, VI at, VI last) {
  const DI di;
  const VI from = hn::Min(at, last);
  const VI shift = hn::ShiftLeft<3>(hn::Sub(at, from));
  const VI four = hn::GatherOffset(di, reinterpret_cast<const int32_t*>(data), from);
  const hn::RebindToUnsigned<DI> du;
  const VI two = hn::BitCast(di, hn::Shr(hn::BitCast(du, four), hn::BitCast(du, shift)));
  const VI byte = hn::Set(di, 255);
  return {hn::And(two, byte), hn::And(hn::ShiftRight<8>(two), byte)};
}

void SampleRow(const GrayImage& source, const float* x, const float* y, int width, uint8_t* gray) {
  const DF df;
  const DI di;
  const hn::Rebind<uint8_t, DF> du8;
  const int lanes = static_cast<int>(hn::Lanes(df));
  const VF half = hn::Set(df, 0.5f), scale = hn::Set(df, 256.0f);
  const VF x_end = hn::Set(df, static_cast<float>(source.width) - 0.5f);
  const VF y_end = hn::Set(df, static_cast<float>(source.height) - 0.5f);
  const VI stride = hn::Set(di, source.width), last_row = hn::Set(di, source.height - 1);
  const VI last = hn::Set(di, source.width * source.height - 4), whole = hn::Set(di, 256);
  HWY_ALIGN uint8_t out[kSlack];
  for (int i = 0; i < width; i += lanes) {
    const VF at_x = hn::LoadU(df, x + i), at_y = hn::LoadU(df, y + i);
    // False for NaN too.
    const auto inside = hn::And(hn::And(hn::Ge(at_x, half), hn::Ge(at_y, half)),
                                hn::And(hn::Lt(at_x, x_end), hn::Lt(at_y, y_end)));
    VI value = hn::Zero(di);
    if (!hn::AllFalse(df, inside)) {
      const VF column = hn::Sub(hn::IfThenElse(inside, at_x, half), half);
      const VF row = hn::Sub(hn::IfThenElse(inside, at_y, half), half);
      const VI x0 = hn::ConvertTo(di, column), y0 = hn::ConvertTo(di, row);
      const VI u = hn::ConvertTo(di, hn::Mul(scale, hn::Sub(column, hn::ConvertTo(df, x0))));
      const VI v = hn::ConvertTo(di, hn::Mul(scale, hn::Sub(row, hn::ConvertTo(df, y0))));
      const VI y1 = hn::Min(hn::Add(y0, hn::Set(di, 1)), last_row);
      const Bytes top = GatherTwo(source.data.data(), hn::Add(hn::Mul(y0, stride), x0), last);
      const Bytes bottom = GatherTwo(source.data.data(), hn::Add(hn::Mul(y1, stride), x0), last);
      const VI u0 = hn::Sub(whole, u), v0 = hn::Sub(whole, v);
      const VI above = hn::Add(hn::Mul(u0, top.first), hn::Mul(u, top.second));
      const VI below = hn::Add(hn::Mul(u0, bottom.first), hn::Mul(u, bottom.second));
      value = hn::Add(hn::Mul(v0, above), hn::Mul(v, below));
      value = hn::ShiftRight<16>(hn::Add(value, hn::Set(di, 1 << 15)));
      value = hn::IfThenElseZero(hn::RebindMask(di, inside), hn::Max(value, hn::Set(di, 1)));
    }
    hn::Store(hn::DemoteTo(du8, value), du8, out);
    std::copy_n(out, std::min(lanes, width - i), gray + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rectify
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace rectify {

HWY_EXPORT(InterpolateRow);
HWY_EXPORT(SampleRow);

void InterpolateRow(const float* above, const float* below, float v, int width, float* x,
                    float* y) {
  HWY_DYNAMIC_DISPATCH(InterpolateRow)(above, below, v, width, x, y);
}

void SampleRow(const GrayImage& source, const float* x, const float* y, int width, uint8_t* gray) {
  HWY_DYNAMIC_DISPATCH(SampleRow)(source, x, y, width, gray);
}

}  // namespace rectify
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
