#include "colmap_seapoint/gaps/gap_changes.h"

#include <algorithm>
#include <cmath>

#include "densify/completeness/surface/asked_area.h"

namespace colmap_seapoint {
namespace {

constexpr double kSameArea = 0.1;  // of the area before
constexpr double kJoinedShare = 0.25;
constexpr size_t kMaxListed = 12;  // ids of one fate

// Area of the gap's cells that lie within.
double AreaWithin(const Gap& gap, const AskedArea& area, double cell_side) {
  const auto& cells = gap.region.cells;
  const auto num_within =
      std::count_if(cells.begin(), cells.end(), [&](const std::pair<int, int>& cell) {
        return area.Contains({(cell.first + 0.5) * cell_side, (cell.second + 0.5) * cell_side});
      });
  return gap.region.area * static_cast<double>(num_within) / static_cast<double>(cells.size());
}

// The gap that most of what is missing of the former one is part of; nullptr: it is closed.
const Gap* JoinedTo(const FormerOutline& outline, double area, const CompletenessResult& result) {
  const AskedArea before{InPlan(outline, result.ground.frame).rings};
  const Gap* joined = nullptr;
  double most = kJoinedShare * area;
  for (const Gap& gap : result.gaps) {
    if (gap.region.layer < outline.layer || outline.layer < gap.region.layer) continue;
    const double within = AreaWithin(gap, before, result.ground.cell_side);
    if (within < most) continue;
    most = within;
    joined = &gap;
  }
  return joined;
}

GapFate FateOf(double before, double now) {
  if (now < (1 - kSameArea) * before) return GapFate::kSmaller;
  return now > (1 + kSameArea) * before ? GapFate::kLarger : GapFate::kAsBefore;
}

// "3", "3 and 7", "3, 5 and 7"; of very many how many more there are.
std::string ListText(const std::vector<int>& ids) {
  const size_t num_listed = ids.size() > kMaxListed + 1 ? kMaxListed : ids.size();
  std::string text;
  for (size_t i = 0; i < num_listed; ++i) {
    if (i > 0) text += i + 1 == ids.size() ? " and " : ", ";
    text += std::to_string(ids[i]);
  }
  if (num_listed < ids.size()) text += " and " + std::to_string(ids.size() - num_listed) + " more";
  return text;
}

std::string PhraseOf(GapFate fate, const std::vector<GapChange>& changes) {
  std::vector<int> ids;
  for (const GapChange& change : changes) {
    if (change.fate == fate) ids.push_back(change.id);
  }
  if (ids.empty()) return "";
  return ListText(ids) + (ids.size() == 1 ? " is " : " are ") + GapFateName(fate);
}

}  // namespace

const char* GapFateName(GapFate fate) {
  switch (fate) {
    case GapFate::kClosed:
      return "closed";
    case GapFate::kSmaller:
      return "smaller";
    case GapFate::kLarger:
      return "larger";
    case GapFate::kJoined:
      return "part of another one";
    case GapFate::kAsBefore:
      break;
  }
  return "as before";
}

std::vector<GapChange> ChangesOf(const FormerReport& former, const CompletenessResult& result) {
  std::vector<GapChange> changes;
  for (size_t i = 0; i < former.gaps.size(); ++i) {
    GapChange change;
    change.id = former.gaps[i].id;
    change.area_before = former.areas[i];
    const auto kept = std::find_if(result.gaps.begin(), result.gaps.end(),
                                   [&](const Gap& gap) { return gap.id == change.id; });
    if (kept != result.gaps.end()) {
      change.area_now = kept->region.area;
      change.fate = FateOf(change.area_before, change.area_now);
    } else if (const Gap* joined = JoinedTo(former.gaps[i], change.area_before, result)) {
      change.area_now = joined->region.area;
      change.joined_to = joined->id;
      change.fate = GapFate::kJoined;
    } else {
      change.fate = GapFate::kClosed;
    }
    changes.push_back(change);
  }
  std::sort(changes.begin(), changes.end(),
            [](const GapChange& a, const GapChange& b) { return a.id < b.id; });
  return changes;
}

std::string ChangesText(const std::vector<GapChange>& changes) {
  std::string text;
  for (const GapFate fate :
       {GapFate::kClosed, GapFate::kSmaller, GapFate::kLarger, GapFate::kJoined}) {
    const std::string phrase = PhraseOf(fate, changes);
    if (!phrase.empty()) text += (text.empty() ? "" : ", ") + phrase;
  }
  const auto num_closed = std::count_if(changes.begin(), changes.end(), [](const auto& change) {
    return change.fate == GapFate::kClosed;
  });
  if (text.empty()) return "";
  const std::string head = num_closed == 0 ? "no gap of the report before is closed, "
                                           : "of the gaps of the report before ";
  return head + text;
}

}  // namespace colmap_seapoint
