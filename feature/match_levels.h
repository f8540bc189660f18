// Matches of pictures with SeaPoints of several levels (ours): what SI-SeaPoints add never takes
// anything away.
#pragma once

#include "feature/match_features.h"

namespace colmap_seapoint {

// As MatchFeatures. Where both pictures have SeaPoints of coarser levels, the finest level is
// matched alone, as if it were all there is; then the run of coarsest levels (feature_levels.h),
// with the tolerances of its own finest level's pixels; and what both found is verified together.
// The pair has the verified matches of the finest level at least. A geometry whose OverlapShare is
// less than `min_overlap_share` counts as none, each time. Cost: that of two MatchFeatures.
MatchedPair MatchLevels(const Camera& camera1, const Features& features1, const Camera& camera2,
                        const Features& features2, const SeaPointMatchingOptions& options,
                        double min_overlap_share);

}  // namespace colmap_seapoint
