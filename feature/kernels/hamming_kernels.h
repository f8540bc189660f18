// The inner loop of MatchHamming: vector code chosen at run time, the same result from every
// version.
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "feature/kernels/nearest.h"

namespace colmap_seapoint {
namespace hamming {

// Distances are the numbers of bits that differ. O(n1 * n2): see MatchHamming for the cost.
NearestNeighbors FindNearest(const std::vector<Descriptor>& descriptors1,
                             const std::vector<Descriptor>& descriptors2, int cap,
                             bool with_second);

}  // namespace hamming
}  // namespace colmap_seapoint
