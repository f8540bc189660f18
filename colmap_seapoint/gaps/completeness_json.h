// completeness.json: the answer in figures, and what the next report needs to find the gaps again
// (former_report.h).
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/gaps/gap_changes.h"
#include "colmap_seapoint/gaps/gap_places.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// `changes`: what became of the gaps of the report before.
std::string CompletenessJson(const CompletenessResult& result, const SparseModel& model,
                             const GapPlaces& places, const std::vector<GapChange>& changes = {});

}  // namespace colmap_seapoint
