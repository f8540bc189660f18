#include "colmap_seapoint/base/picture.h"

#include <algorithm>

#include "colmap_seapoint/base/picture_kernels.h"

namespace colmap_seapoint {
namespace {

constexpr int kBits = 16;
constexpr int kHalf = 1 << (kBits - 1);

constexpr int Fixed(double value) {
  return static_cast<int>(value * (1 << kBits) + (value < 0 ? -0.5 : 0.5));
}

uint8_t Clamped(int value) { return static_cast<uint8_t>(std::clamp(value, 0, 255)); }

// The two chroma samples around a pixel's centre along one axis, and the second one's weight in
// 2^(shift + 1)ths. Beyond the outermost centres the outermost sample counts alone.
struct Between {
  int low, high, weight;
};

Between PlaceOf(int pixel, int shift, int num_samples) {
  // (pixel + 1/2) / 2^shift - 1/2, in 2^(shift + 1)ths.
  const int place = std::max(0, 2 * pixel + 1 - (1 << shift));
  const int low = place >> (shift + 1);
  return {low, std::min(low + 1, num_samples - 1), place & ((2 << shift) - 1)};
}

int Interpolate(const GrayImage& chroma, const Between& x, const Between& y, int shift_x,
                int shift_y) {
  const uint8_t *low = chroma.Row(y.low), *high = chroma.Row(y.high);
  const int span_x = 2 << shift_x, span_y = 2 << shift_y;
  const int top = (span_x - x.weight) * low[x.low] + x.weight * low[x.high];
  const int bottom = (span_x - x.weight) * high[x.low] + x.weight * high[x.high];
  const int sum = (span_y - y.weight) * top + y.weight * bottom;
  return (sum + span_x * span_y / 2) >> (shift_x + shift_y + 2);
}

}  // namespace

GrayImage LumaOf(const ColorImage& color) {
  GrayImage luma(color.width, color.height);
  picture::ToLuma(color.data.data(), luma.data.size(), luma.data.data());
  return luma;
}

Picture PictureOf(const ColorImage& color) {
  Picture result;
  result.luma = LumaOf(color);
  result.cb = result.cr = GrayImage(color.width, color.height);
  picture::ToChroma(color.data.data(), result.cb.data.size(), result.cb.data.data(),
                    result.cr.data.data());
  return result;
}

std::array<uint8_t, 3> ColorAt(const Picture& picture, int x, int y) {
  const int luma = picture.luma.Row(y)[x];
  if (!picture.HasColor()) {
    const auto gray = static_cast<uint8_t>(luma);
    return {gray, gray, gray};
  }
  const int shift_x = picture.chroma_shift_x, shift_y = picture.chroma_shift_y;
  const Between at_x = PlaceOf(x, shift_x, picture.cb.width);
  const Between at_y = PlaceOf(y, shift_y, picture.cb.height);
  const int cb = Interpolate(picture.cb, at_x, at_y, shift_x, shift_y) - 128;
  const int cr = Interpolate(picture.cr, at_x, at_y, shift_x, shift_y) - 128;
  return {Clamped(luma + ((Fixed(1.402) * cr + kHalf) >> kBits)),
          Clamped(luma + ((Fixed(-0.344136286) * cb + Fixed(-0.714136286) * cr + kHalf) >> kBits)),
          Clamped(luma + ((Fixed(1.772) * cb + kHalf) >> kBits))};
}

ColorImage ColorOf(const Picture& picture) {
  ColorImage color(picture.luma.width, picture.luma.height, 3);
  for (int y = 0; y < color.height; ++y) {
    uint8_t* rgb = color.Row(y);
    for (int x = 0; x < color.width; ++x, rgb += 3) {
      const std::array<uint8_t, 3> value = ColorAt(picture, x, y);
      std::copy(value.begin(), value.end(), rgb);
    }
  }
  return color;
}

}  // namespace colmap_seapoint
