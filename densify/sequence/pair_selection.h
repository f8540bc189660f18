// Which picture starts the next pair, and which one completes it (paper 2.5, 2.6).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "densify/sequence/picture_cache.h"
#include "densify/sequence/track.h"

namespace colmap_seapoint {

// Positions below are those of the track.

struct SecondRules {
  int min_num_seeds;       // that a pair needs
  double min_mean_motion;  // share of the picture's longer side (paper 2.6)
};

struct SecondChoice {
  int position = -1;     // -1: there is none
  std::string why_none;  // or empty
};

// The picture that completes the pair of `first`: its simultaneous right one where there is one
// that can be read (paper 4); else the first one that follows on the track with enough matches,
// enough motion (paper 2.6) and a parallax of a degree (ours: motion can be mere rotation). After
// four that match too little the search ends; those that see the same from the same place do not
// count (video, a carrier that hovers), up to 150.
SecondChoice SelectSecond(const SparseModel& model, const Track& track, int first,
                          const SecondRules& rules, PictureCache* pictures);

// Ours, where a completion pass comes back for what the pair does not see: the simultaneous right
// picture likewise; else the first of `ranked` (RankForOpenSurface), wherever on the track, that
// can be read and has enough seeds: matches and triangulated points that both pictures see.
SecondChoice SelectBestSecond(const Track& track, int first, const std::vector<int>& ranked,
                              int min_num_seeds, PictureCache* pictures);

struct NextChoice {
  int position = 0;  // where the next pair starts; Track::CanStartPair tells whether it can
  std::vector<int> passed_over;  // pictures that overlap too much with the pair before
};

// Where the pair after (first, second) starts: SelectNextFirst or, for a simultaneous pair,
// SelectNextStereoFirst.
NextChoice SelectNext(const Track& track, int first, int second, double max_overlap,
                      const std::function<double(int)>& overlap);

// Ours, where all earlier pairs count: the share of a picture that they may cover for it to start a
// pair of its own. Between the two pictures of the last pair half of it is enough: what is open
// there, the next pair, which starts beyond them, sees as well.
double MaxCoveredShare(bool between_last_pair, double max_overlap);

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
