// The inner loops of MeasureInFurtherViews: one small patch of a rectified picture against the same
// place in any other picture. Vector code chosen at run time, the same result from every version.
#pragma once

#include <array>
#include <cstdint>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {
namespace patch {

inline constexpr int kSize = 8;  // pixels across and down
inline constexpr int kPixels = kSize * kSize;
inline constexpr int kBefore = kSize / 2;  // pixels left of and above the one it is centred on

// Patch around a pixel: grey values less 128, and their differences from the pixel before to the
// pixel behind, across and down (twice the gradient).
struct Template {
  alignas(64) std::array<int32_t, kPixels> gray, across, down;
};

// False where the patch, with one pixel around it, reaches beyond the picture or holds a 0 (no
// picture there): then the rest is unset.
bool MakeTemplate(const GrayImage& gray, int x, int y, Template* made);

// Where a picture shows the patch: pixel (i, j) from the middle at x + i x_across + j x_down, ...,
// 65536 = a pixel, (0, 0) the centre of the picture's first pixel.
struct Placement {
  int32_t x, y, x_across, y_across, x_down, y_down;
};

// Sums over the patch: `other` is the picture's grey value less 128, bilinear.
struct Sums {
  int32_t gray = 0, gray_gray = 0, across = 0, down = 0;  // of the template alone
  int32_t across_across = 0, across_down = 0, down_down = 0, gray_across = 0, gray_down = 0;
  int32_t other = 0, other_other = 0, gray_other = 0, across_other = 0, down_other = 0;
};

// Those of the template alone.
Sums SumTemplate(const Template& of);

// Adds those of `other`. All of the placed patch must lie at least a pixel within the picture: from
// the centres of its second column and row to, not quite, those of its last ones.
void SumOther(const Template& of, const GrayImage& picture, const Placement& placement, Sums* sums);

}  // namespace patch
}  // namespace colmap_seapoint
