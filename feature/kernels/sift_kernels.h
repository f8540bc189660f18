// The inner loop of MatchSift: vector code chosen at run time, the same result from every version.
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "feature/kernels/nearest.h"

namespace colmap_seapoint {
namespace sift {

// Distances are inner products with their sign turned. O(n1 * n2): see MatchSift for the cost.
NearestNeighbors FindNearest(const std::vector<SiftDescriptor>& descriptors1,
                             const std::vector<SiftDescriptor>& descriptors2, int cap,
                             bool with_second);

}  // namespace sift
}  // namespace colmap_seapoint
