// Nearest neighbours of SIFT descriptors, one-to-one (paper 4).
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "feature/matching/matching_options.h"

namespace colmap_seapoint {

// Returns COLMAP's measure: the angle between the two in radians, their lengths taken as 512.
double SiftDistance(const SiftDescriptor& a, const SiftDescriptor& b);

// Matches descriptors that are each other's nearest neighbour, at most max_distance apart, and by
// max_ratio nearer than the second nearest in both directions. Ties go to the smaller index. Sorted
// by idx1.
// O(n1 * n2): about 8 ms of CPU for 2500 x 2500 with AVX-512.
FeatureMatches MatchSift(const std::vector<SiftDescriptor>& descriptors1,
                         const std::vector<SiftDescriptor>& descriptors2,
                         const SiftMatcherOptions& options);

}  // namespace colmap_seapoint
