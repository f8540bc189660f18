// Harris measure of every pixel (paper 2.3), in one streaming pass over the picture's rows.
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
// order of summation); only the last step is in float. Scratch memory is a few rows.
FloatImage HarrisMeasure(const GrayImage& picture, const HarrisOptions& options);

}  // namespace colmap_seapoint
