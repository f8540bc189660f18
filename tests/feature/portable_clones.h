// The library's vectorised functions once more, without the AVX2 clone that the loader would
// choose: what a machine without AVX2 runs.
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {

FeatureMatches PortableMatchHamming(const std::vector<Descriptor>& descriptors1,
                                    const std::vector<Descriptor>& descriptors2, int max_distance,
                                    double max_ratio);

}  // namespace colmap_seapoint
