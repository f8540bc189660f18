// Ids that last: a gap keeps its id when the survey grows.
#pragma once

#include <utility>
#include <vector>

#include "densify/completeness/surface/asked_area.h"
#include "densify/completeness/surface/ground.h"

namespace colmap_seapoint {

// A gap of an earlier report, in the plan of its layer.
struct FormerGap {
  int id = 0;
  LayerKey layer;
  std::vector<Ring> rings;  // in the plan of the layer, units
};

struct GapPlace {
  LayerKey layer;
  // Cells of the gap, side `cell_side`, units.
  const std::vector<std::pair<int, int>>* cells = nullptr;
};

// An id for each gap. The pairs that overlap by most area are taken first: a gap inherits the id of
// the former gap that it shares most with, an id goes to one gap alone, and new ones follow the
// largest that was ever given (`last_id`).
std::vector<int> AssignGapIds(const std::vector<GapPlace>& gaps, double cell_side,
                              const std::vector<FormerGap>& former, int last_id);

}  // namespace colmap_seapoint
