#include "feature/kernels/contrast_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "feature/kernels/contrast_kernels.cc"
#include "hwy/foreach_target.h"  // before highway.h: compiles the part below once a target
#include "hwy/highway.h"

// Plain loops: compiled for each target, they become as good as vectors written by hand.

HWY_BEFORE_NAMESPACE();
namespace colmap_seapoint {
namespace contrast {
namespace HWY_NAMESPACE {

void SmoothDown(const std::array<const uint8_t*, kNumTaps>& rows, int width,
                uint16_t* HWY_RESTRICT out) {
  const std::array<const uint8_t*, kNumTaps> r = rows;
  for (int x = 0; x < width; ++x) {
    const auto p0 = static_cast<uint16_t>(r[0][x] + r[12][x]);
    const auto p1 = static_cast<uint16_t>(r[1][x] + r[11][x]);
    const auto p2 = static_cast<uint16_t>(r[2][x] + r[10][x]);
    const auto p3 = static_cast<uint16_t>(r[3][x] + r[9][x]);
    const auto p4 = static_cast<uint16_t>(r[4][x] + r[8][x]);
    const auto p5 = static_cast<uint16_t>(r[5][x] + r[7][x]);
    const auto ends = static_cast<uint16_t>(p0 + 3 * p1 + 6 * p2);
    const auto middle = static_cast<uint16_t>(10 * p3 + 15 * p4 + 18 * p5 + 19 * r[6][x]);
    out[x] = static_cast<uint16_t>(ends + middle);
  }
}

void BoxAcross(const uint16_t* HWY_RESTRICT in, int width, uint16_t* HWY_RESTRICT out) {
  for (int x = 0; x < width; ++x) {
    const unsigned sum =
        (in[x] >> 2) + (in[x + 1] >> 2) + (in[x + 2] >> 2) + (in[x + 3] >> 2) + (in[x + 4] >> 2);
    out[x] = static_cast<uint16_t>(sum);
  }
}

void ShiftRow(const uint16_t* HWY_RESTRICT in, int width, uint16_t* HWY_RESTRICT out) {
  for (int x = 0; x < width; ++x) out[x] = static_cast<uint16_t>((in[x] + 8u) >> 4);
}

void SlideDown(const uint16_t* HWY_RESTRICT entering, const uint16_t* HWY_RESTRICT leaving,
               int width, uint32_t* HWY_RESTRICT sums) {
  for (int x = 0; x < width; ++x) sums[x] += static_cast<uint32_t>(entering[x] - leaving[x]);
}

void SubtractMean(const uint16_t* HWY_RESTRICT smooth, const uint32_t* HWY_RESTRICT sums, int width,
                  float inverse_size, int16_t* HWY_RESTRICT out) {
  for (int x = 0; x < width; ++x) {
    const float mean = static_cast<float>(static_cast<int32_t>(sums[x])) * inverse_size + 0.5f;
    out[x] = static_cast<int16_t>(smooth[x] - static_cast<int32_t>(mean));
  }
}

void MeanOfPairs(const uint8_t* HWY_RESTRICT above, const uint8_t* HWY_RESTRICT below, int width,
                 uint8_t* HWY_RESTRICT out) {
  for (int x = 0; x < width; ++x) {
    const unsigned sum = above[2 * x] + above[2 * x + 1] + below[2 * x] + below[2 * x + 1];
    out[x] = static_cast<uint8_t>((sum + 2) >> 2);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace contrast
}  // namespace colmap_seapoint
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace colmap_seapoint {
namespace contrast {

HWY_EXPORT(SmoothDown);
HWY_EXPORT(BoxAcross);
HWY_EXPORT(ShiftRow);
HWY_EXPORT(SlideDown);
HWY_EXPORT(SubtractMean);
HWY_EXPORT(MeanOfPairs);

void SmoothDown(const std::array<const uint8_t*, kNumTaps>& rows, int width, uint16_t* out) {
  HWY_DYNAMIC_DISPATCH(SmoothDown)(rows, width, out);
}

void BoxAcross(const uint16_t* in, int width, uint16_t* out) {
  HWY_DYNAMIC_DISPATCH(BoxAcross)(in, width, out);
}

void ShiftRow(const uint16_t* in, int width, uint16_t* out) {
  HWY_DYNAMIC_DISPATCH(ShiftRow)(in, width, out);
}

void SlideDown(const uint16_t* entering, const uint16_t* leaving, int width, uint32_t* sums) {
  HWY_DYNAMIC_DISPATCH(SlideDown)(entering, leaving, width, sums);
}

void SubtractMean(const uint16_t* smooth, const uint32_t* sums, int width, float inverse_size,
                  int16_t* out) {
  HWY_DYNAMIC_DISPATCH(SubtractMean)(smooth, sums, width, inverse_size, out);
}

void MeanOfPairs(const uint8_t* above, const uint8_t* below, int width, uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(MeanOfPairs)(above, below, width, out);
}

}  // namespace contrast
}  // namespace colmap_seapoint
#endif  // HWY_ONCE
