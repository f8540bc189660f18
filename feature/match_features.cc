#include "feature/match_features.h"

namespace colmap_seapoint {

void SeaPointMatchingOptions::Bind(OptionTable* table) {
  hamming.Bind(table);
  flow.Bind(table);
  verification.Bind(table);
}

FeatureMatches MatchSeaPoints(const Features& features1, const Features& features2,
                              const SeaPointMatchingOptions& options) {
  const FeatureMatches nearest =
      MatchHamming(features1.descriptors, features2.descriptors, options.hamming);
  return FilterFlow(features1.points, features2.points, nearest, options.flow);
}

MatchedPair MatchFeatures(const Camera& camera1, const Features& features1, const Camera& camera2,
                          const Features& features2, const SeaPointMatchingOptions& options) {
  MatchedPair pair;
  pair.matches = MatchSeaPoints(features1, features2, options);
  pair.geometry = VerifyTwoViews(camera1, features1.points, camera2, features2.points, pair.matches,
                                 options.verification);
  return pair;
}

}  // namespace colmap_seapoint
