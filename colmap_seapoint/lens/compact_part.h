// A few pictures of a large model that see the same ground (ours).
#pragma once

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// The picture with the most observations and, one after the other, those that see most of what the
// chosen ones see, `max_pictures` of them; with the points that two of them see, and all cameras. A
// lens is judged better by hundreds of observations in each of a few pictures than by a few in each
// of thousands, whose poses fit whatever lens there is: of 3,000 pictures the latter chose RADIAL
// for an OPENCV, and the survey bent by 24 mm where it was 5. A model of no more pictures as it is.
SparseModel CompactPart(const SparseModel& model, size_t max_pictures);

}  // namespace colmap_seapoint
