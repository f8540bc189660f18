#include "feature/match_features.h"

#include "feature/picture_turn.h"
#include "feature/rbrief_descriptor.h"
#include "feature/rbrief_pattern.h"

namespace colmap_seapoint {

void SeaPointMatchingOptions::Bind(OptionTable* table) {
  hamming.Bind(table);
  flow.Bind(table);
  verification.Bind(table);
}

FeatureMatches MatchSeaPoints(const Features& features1, const Features& features2,
                              const SeaPointMatchingOptions& options) {
  const int turn = FindPictureTurn(features1, features2);
  const FeatureMatches nearest = MatchHamming(TurnDescriptors(features1.descriptors, turn),
                                              features2.descriptors, options.hamming);
  return FilterFlow(features1.points, features2.points, nearest, turn * kTurnStep, options.flow);
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
