// The water of a survey, from places that its pictures show from several ranges.
#pragma once

#include <vector>

#include "colmap_seapoint/water/water_model.h"

namespace colmap_seapoint {

// Samples in any order; what is not finite, not of positive range, negative or overexposed (a
// channel from 0.98 on) is passed over. Where the water cannot be told (WaterState), colours are
// balanced only. The white balance takes the median of the survey's surfaces, as restored, as grey,
// and leaves the survey as bright as it was.
//
// Lamps that light the middle of a picture more than its edge, and pictures of different exposure,
// are not told from water where they go with the range. Some 10,000 places from across the survey,
// a few samples each, are enough; time is linear, about 0.2 s for these. Never throws for samples,
// whatever they hold.
WaterModel EstimateWater(std::vector<WaterSample> samples);

}  // namespace colmap_seapoint
