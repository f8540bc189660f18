#include "densify/kernels/patch_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "densify/kernels/patch_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace patch {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using DI = hn::CappedTag<int32_t, kSize>;
using VI = hn::Vec<DI>;

HWY_INLINE void AddProduct(VI a, VI b, VI* total) { *total = hn::Add(*total, hn::Mul(a, b)); }

HWY_INLINE int32_t Total(VI total) { return hn::GetLane(hn::SumOfLanes(DI(), total)); }

Sums SumTemplate(const Template& of) {
  const DI di;
  const VI zero = hn::Zero(di);
  VI gray = zero, across = zero, down = zero, gray_gray = zero, gray_across = zero;
  VI gray_down = zero, across_across = zero, across_down = zero, down_down = zero;
  for (size_t i = 0; i < kPixels; i += hn::Lanes(di)) {
    const VI g = hn::Load(di, of.gray.data() + i);
    const VI a = hn::Load(di, of.across.data() + i), d = hn::Load(di, of.down.data() + i);
    gray = hn::Add(gray, g);
    across = hn::Add(across, a);
    down = hn::Add(down, d);
    AddProduct(g, g, &gray_gray);
    AddProduct(a, a, &across_across);
    AddProduct(a, d, &across_down);
    AddProduct(d, d, &down_down);
    AddProduct(g, a, &gray_across);
    AddProduct(g, d, &gray_down);
  }
  Sums sums;
  sums.gray = Total(gray);
  sums.gray_gray = Total(gray_gray);
  sums.across = Total(across);
  sums.down = Total(down);
  sums.across_across = Total(across_across);
  sums.across_down = Total(across_down);
  sums.down_down = Total(down_down);
  sums.gray_across = Total(gray_across);
  sums.gray_down = Total(gray_down);
  return sums;
}

// Bilinear grey values less 128 at fixed-point positions.
HWY_INLINE VI SampleAt(const GrayImage& picture, VI x, VI y) {
  const DI di;
  const VI byte = hn::Set(di, 255), whole = hn::Set(di, 256);
  const VI u = hn::And(hn::ShiftRight<8>(x), byte), v = hn::And(hn::ShiftRight<8>(y), byte);
  const VI at =
      hn::Add(hn::Mul(hn::ShiftRight<16>(y), hn::Set(di, picture.width)), hn::ShiftRight<16>(x));
  const auto* data = picture.data.data();
  // Four bytes from two before the first on, so that nothing behind the last pixel is read: the
  // patch lies one pixel within the picture.
  const VI above = hn::GatherOffset(di, reinterpret_cast<const int32_t*>(data - 2), at);
  const VI below =
      hn::GatherOffset(di, reinterpret_cast<const int32_t*>(data - 2 + picture.width), at);
  const VI u0 = hn::Sub(whole, u), v0 = hn::Sub(whole, v);
  const auto mix = [&](VI four) HWY_ATTR {
    const VI first = hn::And(hn::ShiftRight<16>(four), byte);
    const VI second = hn::And(hn::ShiftRight<24>(four), byte);
    return hn::Add(hn::Mul(u0, first), hn::Mul(u, second));
  };
  const VI value = hn::Add(hn::Mul(v0, mix(above)), hn::Mul(v, mix(below)));
  return hn::Sub(hn::ShiftRight<16>(hn::Add(value, hn::Set(di, 1 << 15))), hn::Set(di, 128));
}

void SumOther(const Template& of, const GrayImage& picture, const Placement& placement,
              Sums* sums) {
  const DI di;
  const VI zero = hn::Zero(di);
  VI other = zero, other_other = zero, gray_other = zero, across_other = zero, down_other = zero;
  for (int j = 0; j < kSize; ++j) {
    const int down = j - kBefore;
    const VI x_row = hn::Set(di, placement.x + down * placement.x_down);
    const VI y_row = hn::Set(di, placement.y + down * placement.y_down);
    for (int i = 0; i < kSize; i += static_cast<int>(hn::Lanes(di))) {
      const VI across = hn::Iota(di, i - kBefore);
      const VI x = hn::Add(x_row, hn::Mul(across, hn::Set(di, placement.x_across)));
      const VI y = hn::Add(y_row, hn::Mul(across, hn::Set(di, placement.y_across)));
      const VI w = SampleAt(picture, x, y);
      const size_t at = static_cast<size_t>(j * kSize + i);
      other = hn::Add(other, w);
      AddProduct(w, w, &other_other);
      AddProduct(hn::Load(di, of.gray.data() + at), w, &gray_other);
      AddProduct(hn::Load(di, of.across.data() + at), w, &across_other);
      AddProduct(hn::Load(di, of.down.data() + at), w, &down_other);
    }
  }
  sums->other = Total(other);
  sums->other_other = Total(other_other);
  sums->gray_other = Total(gray_other);
  sums->across_other = Total(across_other);
  sums->down_other = Total(down_other);
}

}  // namespace HWY_NAMESPACE
}  // namespace patch
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace patch {

HWY_EXPORT(SumTemplate);
HWY_EXPORT(SumOther);

bool MakeTemplate(const GrayImage& gray, int x, int y, Template* made) {
  const int left = x - kBefore, top = y - kBefore;
  if (left < 1 || top < 1 || left + kSize >= gray.width || top + kSize >= gray.height) return false;
  bool is_whole = true;
  size_t at = 0;
  for (int j = 0; j < kSize; ++j) {
    const uint8_t* here = gray.Row(top + j) + left;
    const uint8_t* above = gray.Row(top + j - 1) + left;
    const uint8_t* below = gray.Row(top + j + 1) + left;
    for (int i = 0; i < kSize; ++i, ++at) {
      is_whole = is_whole && here[i] && above[i] && below[i];
      made->gray[at] = here[i] - 128;
      made->across[at] = here[i + 1] - here[i - 1];
      made->down[at] = below[i] - above[i];
    }
    is_whole = is_whole && here[-1] && here[kSize];
  }
  return is_whole;
}

Sums SumTemplate(const Template& of) { return HWY_DYNAMIC_DISPATCH(SumTemplate)(of); }

void SumOther(const Template& of, const GrayImage& picture, const Placement& placement,
              Sums* sums) {
  HWY_DYNAMIC_DISPATCH(SumOther)(of, picture, placement, sums);
}

}  // namespace patch
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
