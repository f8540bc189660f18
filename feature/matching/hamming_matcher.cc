#include "feature/matching/hamming_matcher.h"

#include <algorithm>

#include "feature/kernels/hamming_kernels.h"
#include "feature/matching/mutual_nearest.h"

namespace colmap_seapoint {

namespace {

// From here on a distance does not matter: it is too large for a match, and as a second nearest it
// lets every nearest within max_distance pass.
int DistanceCap(const HammingMatcherOptions& options) {
  int cap = 0;
  while (cap <= 256 && options.max_ratio * cap < options.max_distance) ++cap;
  return std::max(cap, options.max_distance + 1);
}

}  // namespace

int HammingDistance(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    distance += __builtin_popcount(static_cast<unsigned>(a[i] ^ b[i]));
  }
  return distance;
}

FeatureMatches MatchHamming(const std::vector<Descriptor>& descriptors1,
                            const std::vector<Descriptor>& descriptors2,
                            const HammingMatcherOptions& options) {
  const NearestLimits limits = {static_cast<double>(options.max_distance), options.max_ratio};
  const NearestNeighbors nearest =
      hamming::FindNearest(descriptors1, descriptors2, DistanceCap(options), limits.NeedSecond());
  return MatchMutualNearest(nearest, limits, [](int distance) { return distance; });
}

}  // namespace colmap_seapoint
