// The map of Harris measures of a whole picture (paper 2.3). The detector itself keeps no map: it
// takes the rows one by one from feature/detector/harris_rows.h, as this does.
#pragma once

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

struct HarrisOptions {
  double smoothing_sigma;  // of the Gaussian before the gradients, pixels; 0 = none
  int window_size;         // of the box over the gradient products, pixels, odd, at most 11
  double k;                // measure = det - k * trace^2
};

// Returns the width of the border, in pixels, in which the measure would need pixels beyond the
// edge: the map is 0 there.
int HarrisBorder(const HarrisOptions& options);

// Returns the measures of all pixels. Gradients and products are whole numbers, exact whatever the
// order of summation; only the last step is in float.
FloatImage HarrisMeasure(const GrayImage& picture, const HarrisOptions& options);

}  // namespace colmap_seapoint
