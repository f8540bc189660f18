// The partial surface of a rectified pair (paper 2.6, Figures 12 to 14): matches grow from the
// seeds over what is new (propagation), a disparity is measured at every sample (refinement, ours),
// and planes are fitted through them (ours). After each step, what contradicts itself is taken out.
#pragma once

#include <vector>

#include "densify/match/plan_pair.h"
#include "densify/match/surface_fit.h"

namespace colmap_seapoint {

struct MatchedSurface {
  PartialDisparity partial;  // as it was measured: the paper's partial disparity map (Figure 13)
  PartialSurface surface;    // as it goes into the cloud
  int num_failed_seeds = 0;  // that did not spread (paper 2.7)
};

// The same result for any number of threads.
MatchedSurface MatchSurface(const PairPlan& plan, const RectPicture& picture1,
                            const RectPicture& picture2, const Gate& gate,
                            const std::vector<FurtherView>& further, const MatchOptions& options,
                            int num_threads);

}  // namespace colmap_seapoint
