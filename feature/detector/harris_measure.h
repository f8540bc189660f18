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

// How far from the border the measure needs pixels; within it the map is 0.
int HarrisBorder(const HarrisOptions& options);

// Grey levels -> measure, same size. Gradients and products are integers (exact, whatever the
// order of summation); only the last step is in float.
FloatImage HarrisMeasure(const GrayImage& picture, const HarrisOptions& options);

}  // namespace colmap_seapoint
