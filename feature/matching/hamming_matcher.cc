#include "feature/matching/hamming_matcher.h"

#include <algorithm>

#include "feature/kernels/hamming_kernels.h"

namespace colmap_seapoint {

namespace {

// From where on a distance does not matter: neither as the nearest nor as a second nearest, which
// every nearest within max_distance passes against.
int DistanceCap(const HammingMatcherOptions& options) {
  int cap = 0;
  while (cap <= 256 && options.max_ratio * cap < options.max_distance) ++cap;
  return std::max(cap, options.max_distance + 1);
}

}  // namespace

void HammingMatcherOptions::Bind(OptionTable* table) {
  table->Add("SeaPointMatching.max_distance", &max_distance,
             "largest Hamming distance of a match, of 256 bits", "ours", 0, 256);
  table->Add("SeaPointMatching.max_ratio", &max_ratio,
             "largest ratio of nearest to second nearest distance; 1 = no test", "ours", 0.1, 1);
}

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
  const hamming::Nearest none = {DistanceCap(options), DistanceCap(options), 0};
  std::vector<hamming::Nearest> nearest1(descriptors1.size(), none);
  std::vector<hamming::Nearest> nearest2(descriptors2.size(), none);
  hamming::FindNearest(descriptors1, descriptors2, options.max_ratio < 1, &nearest1, &nearest2);
  auto passes = [&](const hamming::Nearest& nearest) {
    return nearest.distance <= options.max_distance &&
           (options.max_ratio >= 1 ||
            nearest.distance <= options.max_ratio * nearest.second_distance);
  };
  FeatureMatches matches;
  for (uint32_t i = 0; i < descriptors1.size(); ++i) {
    if (!passes(nearest1[i])) continue;
    const hamming::Nearest& back = nearest2[nearest1[i].idx];
    if (back.idx == i && passes(back)) matches.push_back({i, nearest1[i].idx});
  }
  return matches;
}

}  // namespace colmap_seapoint
