// The water of a survey, from places that its pictures show from several ranges.
#pragma once

#include <vector>

#include "colmap_seapoint/water/water_model.h"

namespace colmap_seapoint {

// Samples in any order; what is not finite, not of positive range, negative or overexposed (a
// channel from 0.98 on) is passed over. Where the water cannot be told (WaterState), colours are
// balanced only. The white balance takes the median of the survey's surfaces, as restored, as a
// grey in the middle of a picture's bytes.
//
// A camera's automatic exposure, where it follows the range, is in the values too: samples and the
// pixels to be restored must be of the same pictures, both balanced or both not. Some 10,000 places
// from across the survey, a few samples each, are enough; time is linear, 30 microseconds a sample.
// Never throws for samples, whatever they hold.
WaterModel EstimateWater(std::vector<WaterSample> samples);

}  // namespace colmap_seapoint
