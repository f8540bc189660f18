// Which picture starts the next pair, and which one completes it (paper 2.5, 2.6).
#pragma once

#include <functional>
#include <vector>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {

// Positions below are in the sequence (the pictures in the order of their names).

// Whether a pair's matches tell two viewpoints apart (paper 2.6): the mean norm of the vectors, in
// shares of the picture's longer side.
double MeanMotion(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                  const FeatureMatches& matches, double longer_side);

// The first picture of the next pair after (first, second): the first one beyond `second` whose
// overlap with `first` is at most max_overlap. Ours: where the pair that it would start no longer
// touches what `first` sees (overlap of its second picture below a tenth), the one before it is
// taken, so that no strip stays unseen between two pairs; and the sequence ends with the pair of
// its last two pictures. `overlap(position)` is asked for as few pictures as possible. Returns
// num_pictures when no pair is left.
int SelectNextFirst(int second, int num_pictures, double max_overlap,
                    const std::function<double(int)>& overlap);

// The same where a picture's pair is completed by its simultaneous one (paper 4), so that the last
// picture can start a pair too: the first one beyond `first` whose overlap with it is at most
// max_overlap, or the one before it where it no longer overlaps (by a tenth), or the last one.
int SelectNextStereoFirst(int first, int num_pictures, double max_overlap,
                          const std::function<double(int)>& overlap);

}  // namespace colmap_seapoint
