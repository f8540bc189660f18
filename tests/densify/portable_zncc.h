// The library's correlation without the AVX2 clone: what a machine without AVX2 runs.
#pragma once

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

float PortableZncc(const GrayImage& picture1, int x1, int y1, const GrayImage& picture2, int x2,
                   int y2, int size);

}  // namespace colmap_seapoint
