// Tracks that an adjustment has not seen, as the judges of what it found.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/adjustment/equations/robust_loss.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

struct SplitTracks {
  SparseModel fitted;    // with those that may be adjusted
  SparseModel held_out;  // with the others; the same cameras and pictures
};

// Of the tracks of three pictures or more, in the order of their ids, every `held_out_every`th is
// held out. Of the others, and of those that are held out, so many are left away evenly that no
// more observations than this are in either. Features without a track are left away too.
struct TrackSplit {
  size_t held_out_every = 20;
  size_t max_fitted_observations = 20000;
  size_t max_held_out_observations = 20000;
};
SplitTracks Split(const TrackSplit& split, const SparseModel& model);

// The cost of each held-out track (half the sum of RobustLoss::Cost), placed anew where it is
// least as the cameras of `adjusted` see it; those cameras must hold the pictures of `held_out` in
// the same order. In the order of the ids. The same for any number of threads; about 10
// microseconds an observation.
std::vector<double> HeldOutCosts(const SparseModel& held_out, const SparseModel& adjusted,
                                 const RobustLoss& loss, int num_threads);

}  // namespace colmap_seapoint
