// completeness.json: the answer in figures, and what the next report needs to keep the gaps' ids.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/gaps/gap_places.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

std::string CompletenessJson(const CompletenessResult& result, const SparseModel& model,
                             const GapPlaces& places);

struct FormerReport {
  std::vector<FormerOutline> gaps;
  int last_id = 0;
};
// Of an earlier run into the same folder; empty when there is none. Throws Error for a file of that
// name that is none of ours.
FormerReport ReadFormerReport(const std::filesystem::path& path);

}  // namespace colmap_seapoint
