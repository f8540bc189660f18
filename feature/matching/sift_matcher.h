// Nearest neighbours of SIFT descriptors, one-to-one (paper 4).
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

// Not COLMAP's 0.7 and 0.8: the nearest by chance is rarely 0.45 apart, and a ratio test of 0.85
// costs a sixth of the verified matches and more (the flow filter sorts out better).
struct SiftMatcherOptions {
  double max_distance = 0.4;
  double max_ratio = 1.0;

  void Bind(OptionTable* table);
};

// COLMAP's measure: the angle between the two, radians, their lengths taken as 512.
double SiftDistance(const SiftDescriptor& a, const SiftDescriptor& b);

// Mutual nearest neighbours at most max_distance apart whose distance is at most max_ratio of the
// second nearest's, in both directions. Ties go to the smaller index. Sorted by idx1.
// O(n1 * n2): about 8 ms of CPU for 2500 x 2500 with AVX-512.
FeatureMatches MatchSift(const std::vector<SiftDescriptor>& descriptors1,
                         const std::vector<SiftDescriptor>& descriptors2,
                         const SiftMatcherOptions& options);

}  // namespace colmap_seapoint
