#include "colmap_seapoint/gaps/answer_line.h"

#include <algorithm>
#include <cstdio>

#include "colmap_seapoint/gaps/gap_colors.h"

namespace colmap_seapoint {
namespace {

template <typename... Values>
std::string Formatted(const char* format, Values... values) {
  char text[128];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

std::string SpacingText(double spacing, const GapPlaces& places) {
  if (places.Unit() != "m") return Formatted("%.3g ", spacing) + places.Unit();
  return spacing < 0.01 ? Formatted("%.2g mm", 1e3 * spacing) : Formatted("%.2g cm", 1e2 * spacing);
}

}  // namespace

std::string CompletenessLine(const CompletenessResult& result, const SparseModel& model,
                             const GapPlaces& places) {
  const CoverageAt& at = result.coverage[0];
  std::string line = Formatted("%.1f %% (+- %.1f) of the survey is covered at ", 100 * at.share,
                               100 * result.share_tolerance) +
                     SpacingText(result.spacing, places) + " spacing; ";
  if (result.gaps.empty()) return line + "no gap to go back to";
  const Gap& largest =
      *std::max_element(result.gaps.begin(), result.gaps.end(),
                        [](const Gap& a, const Gap& b) { return a.region.area < b.region.area; });
  const std::string unit = places.Unit() == "m" ? "m2" : "square units";
  line += std::to_string(result.gaps.size()) +
          (result.gaps.size() == 1 ? " gap, " : " gaps, the largest ") +
          Formatted("%.2g ", largest.region.area) + unit;
  if (!largest.pictures.empty()) {
    line += " near " + model.images[static_cast<size_t>(largest.pictures[0])].name;
  }
  return line + ": " + CauseText(largest.region.cause) +
         Formatted("; a route of %.3g ", result.route_length) + places.Unit() + " closes them";
}

}  // namespace colmap_seapoint
