#include "colmap_seapoint/base/picture_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "colmap_seapoint/base/picture_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace picture {
namespace HWY_NAMESPACE {

void ToLuma(const uint8_t* HWY_RESTRICT rgb, size_t count, uint8_t* HWY_RESTRICT luma) {
  for (size_t i = 0; i < count; ++i) {
    luma[i] = static_cast<uint8_t>(
        (9798 * rgb[3 * i] + 19235 * rgb[3 * i + 1] + 3735 * rgb[3 * i + 2] + (1 << 14)) >> 15);
  }
}

void ToChroma(const uint8_t* HWY_RESTRICT rgb, size_t count, uint8_t* HWY_RESTRICT cb,
              uint8_t* HWY_RESTRICT cr) {
  constexpr int kCenter = (128 << 16) + (1 << 15) - 1;  // - 1: 255.5 must not become 256
  for (size_t i = 0; i < count; ++i) {
    const int r = rgb[3 * i], g = rgb[3 * i + 1], b = rgb[3 * i + 2];
    cb[i] = static_cast<uint8_t>((-11058 * r - 21710 * g + 32768 * b + kCenter) >> 16);
    cr[i] = static_cast<uint8_t>((32768 * r - 27439 * g - 5329 * b + kCenter) >> 16);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace picture
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace picture {

HWY_EXPORT(ToLuma);
HWY_EXPORT(ToChroma);

void ToLuma(const uint8_t* rgb, size_t count, uint8_t* luma) {
  HWY_DYNAMIC_DISPATCH(ToLuma)(rgb, count, luma);
}

void ToChroma(const uint8_t* rgb, size_t count, uint8_t* cb, uint8_t* cr) {
  HWY_DYNAMIC_DISPATCH(ToChroma)(rgb, count, cb, cr);
}

}  // namespace picture
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
