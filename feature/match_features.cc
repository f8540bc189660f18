#include "feature/match_features.h"

#include <algorithm>
#include <utility>

#include "feature/descriptor/rbrief_descriptor.h"
#include "feature/descriptor/rbrief_pattern.h"
#include "feature/descriptor/sift_descriptor.h"
#include "feature/matching/flow_filter.h"
#include "feature/matching/guided_matcher.h"
#include "feature/matching/hamming_matcher.h"
#include "feature/matching/picture_turn.h"
#include "feature/matching/sift_matcher.h"
#include "feature/matching/two_view_verification.h"

namespace colmap_seapoint {

namespace {

// Picture 1 as picture 2 would see it, as far as descriptors go.
struct TurnedFeatures {
  Features features;
  double turn = 0;  // radians, from x towards y
};

// The SIFT of picture 1 as picture 2 would see it. It is empty when one of them has none, or when
// they are not turned by quarter turns against each other, because SIFT cannot be turned otherwise:
// pictures turned by 12 degrees lose a fifth of their matches by it, by 24 nearly all, while rBRIEF
// is turned freely.
std::vector<SiftDescriptor> TurnSift(const Features& features1, const Features& features2,
                                     int steps) {
  constexpr int kQuarter = kNumTurns / 4;
  std::vector<SiftDescriptor> turned;
  if (features2.sift_descriptors.empty() || steps % kQuarter != 0) return turned;
  for (const SiftDescriptor& descriptor : features1.sift_descriptors) {
    turned.push_back(TurnSiftDescriptor(descriptor, steps / kQuarter));
  }
  return turned;
}

TurnedFeatures TurnTowards(const Features& features1, const Features& features2) {
  const int steps = FindPictureTurn(features1, features2);
  return {{features1.points, TurnDescriptors(features1.descriptors, steps),
           TurnSift(features1, features2, steps)},
          steps * kTurnStep};
}

FeatureMatches MatchNearest(const Features& features1, const Features& features2,
                            const SeaPointMatchingOptions& options) {
  if (features1.sift_descriptors.empty()) {
    return MatchHamming(features1.descriptors, features2.descriptors, options.hamming);
  }
  return MatchSift(features1.sift_descriptors, features2.sift_descriptors, options.sift);
}

FeatureMatches Consolidate(const TurnedFeatures& turned1, const Features& features2,
                           const SeaPointMatchingOptions& options) {
  const FeatureMatches nearest = MatchNearest(turned1.features, features2, options);
  return FilterFlow(turned1.features.points, features2.points, nearest, turned1.turn, options.flow);
}

void Insert(const FeatureMatches& added, FeatureMatches* matches) {
  const auto by_idx1 = [](const FeatureMatch& a, const FeatureMatch& b) { return a.idx1 < b.idx1; };
  FeatureMatches all(matches->size() + added.size());
  std::merge(matches->begin(), matches->end(), added.begin(), added.end(), all.begin(), by_idx1);
  *matches = std::move(all);
}

}  // namespace

FeatureMatches MatchSeaPoints(const Features& features1, const Features& features2,
                              const SeaPointMatchingOptions& options) {
  return Consolidate(TurnTowards(features1, features2), features2, options);
}

MatchedPair MatchFeatures(const Camera& camera1, const Features& features1, const Camera& camera2,
                          const Features& features2, const SeaPointMatchingOptions& options) {
  const TurnedFeatures turned1 = TurnTowards(features1, features2);
  MatchedPair pair;
  pair.matches = Consolidate(turned1, features2, options);
  pair.geometry = VerifyTwoViews(camera1, features1.points, camera2, features2.points, pair.matches,
                                 options.verification);
  const FeatureMatches guided = MatchGuided(camera1, turned1.features, camera2, features2,
                                            pair.matches, pair.geometry, options.guided);
  Insert(guided, &pair.matches);
  Insert(guided, &pair.geometry.inliers);
  return pair;
}

}  // namespace colmap_seapoint
