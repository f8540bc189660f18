// The answer to "did we cover it all?" for the terminal and the summary.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/gaps/gap_changes.h"
#include "colmap_seapoint/gaps/gap_places.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// One line without its end: the share covered, the spacing, how many gaps, the largest one with the
// picture nearest to it and its cause, what it takes to close them, and what became of the gaps of
// the report before.
std::string CompletenessLine(const CompletenessResult& result, const SparseModel& model,
                             const GapPlaces& places, const std::vector<GapChange>& changes = {});

}  // namespace colmap_seapoint
