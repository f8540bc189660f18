// Guided matching (ours): once the geometry of a pair is verified, every SeaPoint that is still
// unmatched is looked for where its matched neighbours say it should be and its epipolar line
// passes, however many SeaPoints elsewhere look more like it. What mutual nearest neighbours lose
// to repetitive or hazy texture comes back.
#pragma once

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/features.h"
#include "feature/matching/matching_options.h"

namespace colmap_seapoint {

// Returns the pairs of SeaPoints to be added to geometry.inliers and to the pair's matches, which
// hold neither of the two yet: sorted by idx1, one-to-one. Descriptors are compared as they are, so
// turn them first (picture_turn.h). A point's place in picture 2 is predicted from the inliers
// around it (local_flow.h); candidates lie within max_slip, or max_slip_ratio times what is usual
// there, whichever is more, and within max_error of the epipolar line. The smallest Hamming
// distance of all wins first; ties go to the smaller indices. Nothing is added to a pair with fewer
// than 20 inliers, without E and F, or whose inliers do not fill the overlap that they imply
// (overlap_share.h). O(n log n).
FeatureMatches MatchGuided(const Camera& camera1, const Features& features1, const Camera& camera2,
                           const Features& features2, const FeatureMatches& matches,
                           const TwoViewGeometry& geometry, const GuidedMatcherOptions& options);

}  // namespace colmap_seapoint
