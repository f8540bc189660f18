// Paper 2.3 word by word: slow, and written without a look at the detector's way of computing.
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"
#include "feature/detector/harris_measure.h"
#include "feature/detector/local_maxima.h"
#include "feature/detector/seapoint_detector.h"

namespace colmap_seapoint {

// "the calculation of Harris measures for each pixel"
FloatImage OracleHarrisMeasure(const GrayImage& picture, const HarrisOptions& options);

// "This accumulation continues until the cumulative sum reaches the minimum of the target interval
// ... In such cases, we recalculate the histogram for the values located between the current bin's
// bounds". Returns the threshold; infinity when no value is kept.
float OracleThreshold(const std::vector<float>& measures, int min_count, int max_count);

// Greatest of its window, of equals the first in raster order.
LocalMaxima OracleLocalMaxima(const FloatImage& map, const GrayImage& mask, int radius, int border);

// Everything of Figure 4, and the sub-pixel fit. nms_radius must be given.
std::vector<SeaPoint> OracleDetect(const GrayImage& picture, const GrayImage& mask,
                                   const SeaPointExtractionOptions& options, int border);

}  // namespace colmap_seapoint
