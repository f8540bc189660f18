// Whether a pair's matches fill the overlap that they themselves imply (ours).
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {

// Of pairs that need not overlap. On synthetic dives with exact truth, several in a hundred pairs
// without any overlap reach 15 inliers, and a few 90 and more, but none matches 10 % of the overlap
// it implies. Of the pairs that overlap by 20 %, nearly all match more. One false link folds a
// model.
inline constexpr double kMinOverlapShare = 0.12;

// Matches, as a share of the SeaPoints that lie in the overlap when the first picture is turned and
// moved onto the second as the matches tell. Two pictures of one place match all over their overlap
// (measured on synthetic dives: half of the SeaPoints there, a third in murk). Matches between two
// places that look alike are a patch in the midst of pictures that should then match everywhere
// (1 to 9 %, however many they are). 0 without matches. O(points).
double OverlapShare(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                    const FeatureMatches& matches);

}  // namespace colmap_seapoint
