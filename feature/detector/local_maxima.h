// Local maxima of the Harris measure (paper 2.3), found while the measures stream by.
#pragma once

#include <vector>

#include "colmap_seapoint/base/image.h"
#include "feature/detector/harris_measure.h"

namespace colmap_seapoint {

struct LocalMaximum {
  int x = 0, y = 0;
  float around[9] = {};  // measures of the 3 x 3 neighbourhood, in raster order
  float measure() const { return around[4]; }
};

struct LocalMaxima {
  std::vector<LocalMaximum> maxima;  // in raster order
  float lowest = 0, highest = 0;     // extremes of the whole map
};

// Finds every pixel whose measure is above 0 (below it are edges, and at 0 there is no texture) and
// the greatest in its (2 radius + 1)^2 window, of equal ones the first in raster order. There is
// none nearer to the picture's edge than `border` pixels (at least HarrisBorder() + 1), and none
// where `mask` (empty, or of the picture's size) is 0.
//
// One pass over the picture: 2 radius + 1 rows of measures exist at once, and no map. `num_threads`
// (-1: all cores) share the picture in bands of rows; the result is the same for any number.
LocalMaxima FindLocalMaxima(const GrayImage& picture, const GrayImage& mask,
                            const HarrisOptions& options, int radius, int border, int num_threads);

}  // namespace colmap_seapoint
