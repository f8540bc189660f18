#include "colmap_seapoint/watch/small_copy.h"

#include <algorithm>

namespace colmap_seapoint {
namespace {

uint8_t MeanOf(const ColorImage& picture, int x, int y, int side, int channel) {
  int sum = 0;
  for (int b = y; b < y + side; ++b) {
    for (int a = x; a < x + side; ++a) sum += picture.At(a, b, channel);
  }
  return static_cast<uint8_t>((sum + side * side / 2) / (side * side));
}

}  // namespace

ColorImage SmallCopy(const ColorImage& picture) {
  const int side = std::max(1, std::max(picture.width, picture.height) / kSmallCopySide);
  if (side == 1 || std::min(picture.width, picture.height) < side) return picture;
  ColorImage copy(picture.width / side, picture.height / side, picture.channels);
  for (int y = 0; y < copy.height; ++y) {
    for (int x = 0; x < copy.width; ++x) {
      for (int c = 0; c < copy.channels; ++c) {
        copy.At(x, y, c) = MeanOf(picture, x * side, y * side, side, c);
      }
    }
  }
  return copy;
}

}  // namespace colmap_seapoint
