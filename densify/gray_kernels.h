// Colour to grey. Vector code chosen at run time, the same result from every version.
#pragma once

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// 0.299 red + 0.587 green + 0.114 blue, in 256ths, rounded.
GrayImage GrayOfColor(const ColorImage& color);

}  // namespace colmap_seapoint
