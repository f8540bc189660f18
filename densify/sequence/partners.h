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

// Counts as covered, at their predicted ranges, the cells of `view` that both pictures of a pair
// see well: what the pair could not measure there is left to the completion pass, which tries
// others.
void MarkSeenByBoth(const View& view, const std::vector<double>& predicted_range,
                    const View& pair_view1, const View& pair_view2, ViewCoverage* coverage);

// Those of `partners` that measure a hundredth of the picture that nothing covers yet, at its
// predicted ranges (PredictRanges), best first. A place counts by its ViewQuality times the root of
// its parallax: a range is measured as well as its parallax is large, but the wider pair sees less,
// and fails more often; what it misses is left to the completion pass.
std::vector<int> RankForOpenSurface(const Track& track, const View& view,
                                    const ViewCoverage& coverage,
                                    const std::vector<double>& predicted_range,
                                    const std::vector<int>& partners);

}  // namespace colmap_seapoint
