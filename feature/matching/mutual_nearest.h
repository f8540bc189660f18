// One-to-one matches of any kind of descriptor (paper 2.4): what rBRIEF and SIFT share.
#pragma once

#include <cstdint>

#include "colmap_seapoint/base/features.h"
#include "feature/kernels/nearest.h"

namespace colmap_seapoint {

// `max_distance`, and the largest share of the second nearest's distance; 1 = no such test.
struct NearestLimits {
  double max_distance;
  double max_ratio;

  bool NeedSecond() const { return max_ratio < 1; }
};

// Pairs that are each other's nearest and pass the limits in both directions. Sorted by idx1.
// `distance_of`: from the kernel's whole numbers to the distance that the limits mean; it must not
// let the kernel's cap pass as a nearest distance.
template <typename DistanceOf>
FeatureMatches MatchMutualNearest(const NearestNeighbors& nearest, const NearestLimits& limits,
                                  const DistanceOf& distance_of) {
  const auto passes = [&](const Nearest& one) {
    const auto distance = distance_of(one.distance);
    return distance <= limits.max_distance &&
           (!limits.NeedSecond() ||
            distance <= limits.max_ratio * distance_of(one.second_distance));
  };
  FeatureMatches matches;
  for (uint32_t i = 0; i < nearest.of1.size(); ++i) {
    if (!passes(nearest.of1[i])) continue;
    const uint32_t j = nearest.of1[i].idx;
    if (nearest.of2[j].idx == i && passes(nearest.of2[j])) matches.push_back({i, j});
  }
  return matches;
}

}  // namespace colmap_seapoint
