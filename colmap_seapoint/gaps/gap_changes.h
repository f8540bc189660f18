// What became of the gaps of the report before: "which of them has this dive closed?"
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/gaps/former_report.h"

namespace colmap_seapoint {

enum class GapFate { kClosed, kSmaller, kAsBefore, kLarger, kJoined };
const char* GapFateName(GapFate fate);  // "closed", ...

struct GapChange {
  int id = 0;
  GapFate fate = GapFate::kAsBefore;
  double area_before = 0, area_now = 0;  // units^2; now: of the gap of this id, or that it joined
  int joined_to = 0;                     // id; 0: none
};

// One a gap of the report before, by id. A gap that kept its id is as before while its area is
// within a tenth. One whose id is gone is closed, but where a quarter of it or more is part of
// another gap now.
std::vector<GapChange> ChangesOf(const FormerReport& former, const CompletenessResult& result);

// "of the gaps of the report before 3 and 7 are closed, 5 is smaller"; "" where all are as they
// were.
std::string ChangesText(const std::vector<GapChange>& changes);

}  // namespace colmap_seapoint
