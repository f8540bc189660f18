// Both pictures of a planned pair in its rectified frame, as far as they are needed, and where
// picture 1 may be matched (paper 2.6; the rectification is ours).
#pragma once

#include <vector>

#include "densify/match/plan_pair.h"

namespace colmap_seapoint {

struct RectifiedPair {
  RectMap map1;                   // where picture 1's rectified pixels come from
  Gate gate;                      // closed, open, or covered at a disparity; at nodes
  std::vector<int> cell_of_node;  // of picture 1; -1 outside it
  RectPicture picture1, picture2;
};

// Only the blocks of a window that something may be matched in are rectified; the rest stays 0. The
// same result for any number of threads.
RectifiedPair RectifyPair(const PairInput& input, const PairPlan& plan, int num_threads);

}  // namespace colmap_seapoint
