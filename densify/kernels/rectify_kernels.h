// The inner loops of RectMap. Vector code chosen at run time, the same result from every version.
#pragma once

#include <cstdint>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {
namespace rectify {

inline constexpr int kCell = 8;    // pixels between the nodes of a map
inline constexpr int kSlack = 16;  // values behind a row that may be overwritten

// Source positions of a row of pixels: linear between the nodes (x, y interleaved, one every kCell
// pixels) of the node rows above and below, `v` of the way down.
void InterpolateRow(const float* above, const float* below, float v, int width, float* x, float* y);

// Bilinear grey values at those positions, 1 .. 255; 0 outside the picture or where a position is
// not a number.
void SampleRow(const GrayImage& source, const float* x, const float* y, int width, uint8_t* gray);

}  // namespace rectify
}  // namespace colmap_seapoint
