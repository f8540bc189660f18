#include "tests/feature/portable_clones.h"

#include "colmap_seapoint/base/vector_clones.h"

#undef SEAPOINT_VECTOR_CLONES
#define SEAPOINT_VECTOR_CLONES

// Everything with a linker name gets another one, so that both versions live in one program.
#define HammingDistance ClonelessHammingDistance
#define HammingMatcherOptions ClonelessHammingMatcherOptions
#define MatchHamming ClonelessMatchHamming
#include "feature/hamming_matcher.cc"  // NOLINT(bugprone-suspicious-include)


namespace colmap_seapoint {

FeatureMatches PortableMatchHamming(const std::vector<Descriptor>& descriptors1,
                                    const std::vector<Descriptor>& descriptors2, int max_distance,
                                    double max_ratio) {
  ClonelessHammingMatcherOptions options;
  options.max_distance = max_distance;
  options.max_ratio = max_ratio;
  return ClonelessMatchHamming(descriptors1, descriptors2, options);
}

}  // namespace colmap_seapoint
