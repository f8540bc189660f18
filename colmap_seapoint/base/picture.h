// A colour picture as JPEG files hold it: brightness in full, colour reduced. Densification looks
// at the brightness of every pixel, but at the colour of the sampled points only; so colour is kept
// as it comes and worked out where it is asked for.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// YCbCr by JFIF: full range, ITU-R BT.601, chroma 128 is grey. A chroma sample is the mean of
// 2^chroma_shift_x columns and 2^chroma_shift_y rows; the last ones of odd sizes stand for fewer.
struct Picture {
  GrayImage luma;          // 0.299 red + 0.587 green + 0.114 blue, full resolution
  GrayImage cb, cr;        // ceil(width / 2^shift_x) x ceil(height / 2^shift_y); empty: no colour
  int chroma_shift_x = 0;  // 0, 1, 2
  int chroma_shift_y = 0;  // 0, 1, 2
  // Of luma's size, 0 where the picture shows what is not to be reconstructed; empty: nowhere.
  GrayImage mask;

  bool Empty() const { return luma.Empty(); }
  bool HasColor() const { return !cb.Empty(); }
  size_t NumBytes() const {
    return luma.data.size() + cb.data.size() + cr.data.size() + mask.data.size();
  }
};

// Returns 0.299 red + 0.587 green + 0.114 blue, in 2^15ths, rounded: the same as OpenCV's RGB2GRAY.
GrayImage LumaOf(const ColorImage& color);

// Returns luma and chroma of red, green and blue at full resolution, 3 bytes a pixel. On the way
// back a colour is off by 2 levels at most, because 8 bits do not hold the chroma's fractions.
// About 1 ns a pixel.
Picture PictureOf(const ColorImage& color);

// Returns red, green and blue of pixel (x, y), which must lie inside. Chroma is interpolated
// linearly between its samples' centres, as JPEG decoders do. Grey for a picture without colour.
// About 10 ns.
std::array<uint8_t, 3> ColorAt(const Picture& picture, int x, int y);

// Returns ColorAt of all pixels.
ColorImage ColorOf(const Picture& picture);

}  // namespace colmap_seapoint
