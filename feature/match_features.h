// The spine of matching (paper 2.4, Figure 8): how far the pictures are turned against each other
// (ours) -> nearest neighbours, one-to-one -> flow filter -> two-view geometry -> guided matches
// (ours). Neighbours are found by rBRIEF, and by SIFT between two pictures that have it and are
// turned against each other by quarter turns.
#pragma once

#include <string>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/features.h"
#include "feature/matching/matching_options.h"

namespace colmap_seapoint {

// Raise it whenever the same SeaPoints and options give other matches than before, together with
// the hashes in tests/feature/matching_version_test.cc.
inline constexpr char kMatchingVersion[] = "5";

struct MatchedPair {
  FeatureMatches matches;  // one-to-one, flow-filtered and guided: COLMAP's `matches`
  TwoViewGeometry geometry;
};

// Returns the consolidated matches only, without geometry: the paper's inter- and intrapair
// matching (2.4). `features1` and `features2` are pixels of the full-size pictures.
FeatureMatches MatchSeaPoints(const Features& features1, const Features& features2,
                              const SeaPointMatchingOptions& options);

// Returns the consolidated matches and their geometry. Runs on the caller's thread; the same input
// gives the same result. Cost: about 0.03 CPU s a pair of 3000 points; with SIFT 0.01 more.
MatchedPair MatchFeatures(const Camera& camera1, const Features& features1, const Camera& camera2,
                          const Features& features2, const SeaPointMatchingOptions& options);

}  // namespace colmap_seapoint
