// Gaps as a person goes back to them: what one pass photographs together is one gap.
#pragma once

#include <vector>

#include "densify/completeness/gaps/closing_pass.h"

namespace colmap_seapoint {

struct PassRegions {
  std::vector<GapRegion> regions;
  double unlisted_area = 0;  // units^2, of what is too small to go back to
};

// A region smaller than a picture belongs to a larger one of its cause when all of it lies within
// half a picture of that one's cells; the smallest (a hundredth of a picture and less) to a larger
// one of any cause, since the pass over that one photographs it too. What is then still smaller
// than a hundredth of a picture is left out. Largest first in every layer, layers in their order.
PassRegions MergeIntoPasses(std::vector<GapRegion> regions, const PassPlan& plan, double cell_side);

}  // namespace colmap_seapoint
