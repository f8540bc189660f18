// Nearest neighbours of SIFT descriptors, one-to-one (paper 4).
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/options.h"

namespace colmap_seapoint {

// Not COLMAP's 0.7 and 0.8: upright RootSIFT of local detail is never 0.5 apart even by chance, and
// a ratio test costs a fifth of the verified matches and more (the flow filter sorts out better).
struct SiftMatcherOptions {
  double max_distance = 0.4;
  double max_ratio = 1.0;

  void Bind(OptionTable* table);
};

// COLMAP's measure: the angle between the two, radians, their lengths taken as 512.
double SiftDistance(const SiftDescriptor& a, const SiftDescriptor& b);

// Mutual nearest neighbours at most max_distance apart whose distance is at most max_ratio of the
// second nearest's, in both directions. Ties go to the smaller index. Sorted by idx1.
// O(n1 * n2): about 25 ms of CPU for 3000 x 3000 with AVX2.
FeatureMatches MatchSift(const std::vector<SiftDescriptor>& descriptors1,
                         const std::vector<SiftDescriptor>& descriptors2,
                         const SiftMatcherOptions& options);

}  // namespace colmap_seapoint
