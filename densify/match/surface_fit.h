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
};

// Least squares over the samples up to `radius` samples away (at most 4) whose disparity differs by
// at most max_slope pixels a pixel of `radius`; where fewer than 6 do, the sample's own. The same
// result for any number of threads and vector code. Cost: about 0.3 ns a sample fitted to.
PartialSurface FitSurface(const PartialDisparity& partial, int radius, float max_slope,
                          int num_threads);

}  // namespace colmap_seapoint
