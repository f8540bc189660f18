// Two models as one, once it is known how they lie (ours).
#pragma once

#include <set>

#include "colmap_seapoint/joining/link_consensus.h"

namespace colmap_seapoint {

struct MergedModel {
  SparseModel model;         // in the frame of `b`; pictures by id
  std::set<uint64_t> links;  // points that pictures of both models see
};

// All of `b`, and all that only `a` holds, brought into b's frame. Cameras of both, and pictures of
// both, are as in `b`. Points that the consensus links become one, unless it would then be in one
// picture twice; points seen by fewer than two pictures afterwards are dropped. The models keep
// COLMAP's rule that equal image and camera ids are the same picture and camera.
MergedModel MergeModels(const SparseModel& a, const SparseModel& b,
                        const std::vector<ModelLink>& links, const LinkConsensus& consensus);

}  // namespace colmap_seapoint
