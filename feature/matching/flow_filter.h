// The flow filter (paper 2.4, Figures 8 and 9): the vector from a SeaPoint to its match must agree,
// in direction and norm, with those of its neighbours.
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "feature/matching/matching_options.h"

namespace colmap_seapoint {

// Keeps the matches that at least min_votes of their num_neighbors nearest neighbours (in the first
// picture, among the matches) vote for: direction within max_angle_deg and norm within
// max_norm_difference of the larger norm, or the vectors less than min_tolerance pixels apart
// (ours: at small motion the direction says nothing). `turn` is how far picture 2 is turned against
// picture 1, in radians from x towards y; the vectors are those that are left once picture 1 is
// turned likewise about its middle (ours: the flow of a neighbouring strip, flown the other way, is
// then as even as that of the next picture).
//
// Second look (ours): a match that ends on a neighbour of the true SeaPoint, some pixels beside it,
// passes that vote. So a match that is left must also lie within max_slip pixels of where its
// nearest matches say it should (local_flow.h), or within max_slip_ratio times what is usual around
// it, whichever is more, because parallax makes more usual at relief. Order is kept. O(n log n).
FeatureMatches FilterFlow(const std::vector<SeaPoint>& points1,
                          const std::vector<SeaPoint>& points2, const FeatureMatches& matches,
                          double turn, const FlowFilterOptions& options);

}  // namespace colmap_seapoint
