// The pictures that make good pairs with a picture, wherever on the track they stand (ours).
#pragma once

#include <vector>

#include "densify/match/view.h"
#include "densify/overlap/coverage.h"
#include "densify/sequence/covisibility.h"
#include "densify/sequence/track.h"

namespace colmap_seapoint {

// The positions whose pictures measure best what they share with the one at `position`, best first
// (SharedPoints::quality), ties by position; at most 32. Of pictures that stand beside each other
// and look the same way (video, a carrier that hovers) the best one stands for all.
std::vector<int> BestPartners(const Track& track, const Covisibility& covisibility, int position);

// Those of `partners` that see enough of the surface in `view` that nothing covers yet, at its
// predicted ranges (PredictRanges), in the order in which they are to be tried: the widest baseline
// first of those that measure nearly as much of it as the best one does, then the others, best
// first. Wide baselines measure range best, and what they miss is left to the completion pass.
std::vector<int> RankForOpenSurface(const Track& track, const View& view,
                                    const ViewCoverage& coverage,
                                    const std::vector<double>& predicted_range,
                                    const std::vector<int>& partners);

}  // namespace colmap_seapoint
