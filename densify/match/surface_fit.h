// Planes through the samples around each one, on its side of any depth edge (ours): what is noise
// averages out, the slope gives the normal, and what nothing around supports is found out.
#pragma once

#include <cstdint>
#include <vector>

#include "densify/match/sample_grid.h"

namespace colmap_seapoint {

// The surface at every sample: disparity(x, y) = disparity + slope_x (x - x0) + slope_y (y - y0).
struct PartialSurface {
  SampleGrid grid;
  std::vector<float> disparity;         // 0: none
  std::vector<float> slope_x, slope_y;  // pixels of disparity a pixel; 0 where too few agree
  std::vector<uint8_t> support;         // samples that agree, itself too
  std::vector<float> deviation;         // of the disparity, rect pixels
  std::vector<float> confidence;        // 0..1, once AssessConfidence has set it (confidence.h)
};

// Least squares over the samples up to `radius` samples away (at most 4) whose disparity differs by
// at most max_slope pixels a pixel of `radius`; where fewer than 6 do, the sample's own. The same
// result for any number of threads and vector code. Cost: about 0.3 ns a sample fitted to.
// The deviation is the sample's own (none: 0) and the scatter of the samples about the plane, as
// the root of the sum of squares; and it counts the more, the fewer samples agree of those that
// could: at depth edges, at rims, on what is rough.
PartialSurface FitSurface(const PartialDisparity& partial, int radius, float max_slope,
                          int num_threads);

// The same at two scales: where the samples scatter clearly more about the plane of `radius` than
// about that of half of it, the surface is not plane so far, and the smaller one's counts. The
// deviation stays that of the larger one.
PartialSurface FitRoughSurface(const PartialDisparity& partial, int radius, float max_slope,
                               int num_threads);

}  // namespace colmap_seapoint
