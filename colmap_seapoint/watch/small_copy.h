// Smaller copies of pictures, for answers while a survey is being made.
#pragma once

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

// Pixels; no side of a copy is made smaller than this by its longer side.
inline constexpr int kSmallCopySide = 560;

// Each pixel the mean of as many whole ones across as down: the longer side is 560 pixels at least,
// less than twice that, or what it was.
ColorImage SmallCopy(const ColorImage& picture);

}  // namespace colmap_seapoint
