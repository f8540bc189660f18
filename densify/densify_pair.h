// One pair -> one partial local cloud (paper 2.6, Figure 14): plan, rectify, match the surface,
// reproject.
#pragma once

#include <string>
#include <vector>

#include "densify/cloud/partial_cloud.h"
#include "densify/match/plan_pair.h"
#include "densify/overlap/packed_footprint.h"
#include "densify/partial_densification_options.h"

namespace colmap_seapoint {

struct PairResult {
  std::string failure;       // why there is nothing, or empty
  PartialDisparity partial;  // what the cloud was made of, before it was smoothed (Figure 13)
  PartialCloud cloud;
  CloudFootprint footprint;   // of what is new
  std::vector<float> filled;  // share of each cell's samples that hold surface, 0..1
  int num_seeds = 0;          // that were usable: on the epipolar line, in an open cell
  int num_failed_seeds = 0;   // that did not spread
  double rectification_seconds = 0, propagation_seconds = 0;  // wall
};

// Never throws for what the pictures hold: a pair that gives nothing says why in `failure`. The
// same result for any number of threads. Cost and memory grow with what is new, not with the
// picture.
PairResult DensifyPair(const PairInput& input, const PartialDensificationOptions& options,
                       int num_threads);

}  // namespace colmap_seapoint
