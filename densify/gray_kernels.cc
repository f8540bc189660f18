#include "densify/gray_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "densify/gray_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// `count` pixels, three bytes each.
void ToGray(const uint8_t* rgb, size_t count, uint8_t* gray) {
  size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<uint8_t> d8;
  const hn::Half<decltype(d8)> half;
  const hn::RepartitionToWide<decltype(d8)> d16;
  const auto luma = [&](auto r, auto g, auto b) HWY_ATTR {  // 16 bits hold 255 * 256 + 128
    const auto sum = hn::Add(hn::Add(hn::Mul(r, hn::Set(d16, 77)), hn::Mul(g, hn::Set(d16, 150))),
                             hn::Add(hn::Mul(b, hn::Set(d16, 29)), hn::Set(d16, 128)));
    return hn::DemoteTo(half, hn::BitCast(hn::RebindToSigned<decltype(d16)>(),
                                          hn::ShiftRight<8>(sum)));
  };
  const size_t lanes = hn::Lanes(d8);
  for (; i + lanes <= count; i += lanes) {
    hn::Vec<decltype(d8)> r, g, b;
    hn::LoadInterleaved3(d8, rgb + 3 * i, r, g, b);
    const auto low = luma(hn::PromoteTo(d16, hn::LowerHalf(half, r)),
                          hn::PromoteTo(d16, hn::LowerHalf(half, g)),
                          hn::PromoteTo(d16, hn::LowerHalf(half, b)));
    const auto high = luma(hn::PromoteTo(d16, hn::UpperHalf(half, r)),
                           hn::PromoteTo(d16, hn::UpperHalf(half, g)),
                           hn::PromoteTo(d16, hn::UpperHalf(half, b)));
    hn::StoreU(low, half, gray + i);
    hn::StoreU(high, half, gray + i + lanes / 2);
  }
#endif
  for (; i < count; ++i) {
    gray[i] = static_cast<uint8_t>(
        (77 * rgb[3 * i] + 150 * rgb[3 * i + 1] + 29 * rgb[3 * i + 2] + 128) >> 8);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {

HWY_EXPORT(ToGray);

GrayImage GrayOfColor(const ColorImage& color) {
  GrayImage gray(color.width, color.height);
  HWY_DYNAMIC_DISPATCH(ToGray)(color.data.data(), gray.data.size(), gray.data.data());
  return gray;
}

}  // namespace colmap_seapoint
#endif  // HWY_ONCE
