// What rBRIEF compares: the smoothed picture less its mean over a wide box (ours). The box takes
// out haze and the glow of a lamp that moves with the camera: matches on ROV pictures with such a
// lamp 0.34 -> 0.39, in turbid water 0.26 -> 0.33 of the points, on evenly lit strips none lost.
#pragma once

#include <cstdint>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

inline constexpr double kContrastSigma = 2.45;  // of the smoothing: three boxes of 5 pixels
inline constexpr int kContrastBoxRadius = 30;   // of the box whose mean is taken out, pixels
inline constexpr double kContrastUnit = 15625.0 / 1024;  // steps of the result a grey level

// Of the picture's size. Beyond the edge the smoothing sees the edge's pixels; near it the box is
// the nearest that lies inside the picture (and as large as the picture when that is smaller).
// Exact integers: the same on every machine. Cost: about 2 CPU ms a megapixel.
Image<int16_t> LocalContrast(const GrayImage& picture);

// The mean of every 2 x 2 pixels; what is left over at the right and lower edge is dropped.
GrayImage HalfSize(const GrayImage& picture);

}  // namespace colmap_seapoint
