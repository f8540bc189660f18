// Tells whether a pair's matches fill the overlap that they themselves imply (ours).
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {

// The least share that is believed of a pair that need not overlap, such as a loop candidate. On
// synthetic dives with exact truth, several in a hundred pairs without any overlap reach 15
// inliers, and a few 90 and more, but none matches 10 % of the overlap it implies, while nearly all
// pairs that overlap by 20 % match more. The limit is strict because one false link folds a model.
inline constexpr double kMinOverlapShare = 0.12;

// Returns the matches as a share, 0 to 1, of the first picture's SeaPoints that lie in the overlap
// once that picture is turned and moved onto the second as the matches tell. Two pictures of one
// place match all over their overlap (measured on synthetic dives: half of the SeaPoints there, a
// third in murk). Two places that merely look alike match in a patch, in the midst of pictures that
// should then match everywhere (1 to 9 %, however many matches these are). 0 without matches.
// O(points).
double OverlapShare(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                    const FeatureMatches& matches);

}  // namespace colmap_seapoint
