#include "colmap_seapoint/gaps/answer_line.h"

#include <algorithm>
#include <cmath>
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

// To so many digits that count, and never with an exponent: 3900, 1.4, 0.0032.
std::string Rounded(double value, int digits) {
  if (!(value > 0)) return "0";
  const int last = static_cast<int>(std::floor(std::log10(value))) - digits + 1;
  const double step = std::pow(10, last);
  return Formatted("%.*f", std::max(0, -last), step * std::round(value / step));
}

std::string SpacingText(double spacing, const GapPlaces& places) {
  if (places.Unit() != "m") return Rounded(spacing, 3) + " " + places.Unit();
  return spacing < 0.01 ? Rounded(1e3 * spacing, 2) + " mm" : Rounded(1e2 * spacing, 2) + " cm";
}

std::string Appended(const std::string& text) { return text.empty() ? "" : "; " + text; }

}  // namespace

std::string CompletenessLine(const CompletenessResult& result, const SparseModel& model,
                             const GapPlaces& places, const std::vector<GapChange>& changes) {
  const std::string changed = ChangesText(changes);
  const CoverageAt& at = result.coverage[0];
  std::string line = Formatted("%.1f %% (+- %.1f) of the survey is covered at ", 100 * at.share,
                               100 * result.share_tolerance) +
                     SpacingText(result.spacing, places) + " spacing; ";
  if (result.gaps.empty()) return line + "no gap to go back to" + Appended(changed);
  const Gap& largest =
      *std::max_element(result.gaps.begin(), result.gaps.end(),
                        [](const Gap& a, const Gap& b) { return a.region.area < b.region.area; });
  const std::string unit = places.Unit() == "m" ? "m2" : "square units";
  line += std::to_string(result.gaps.size()) +
          (result.gaps.size() == 1 ? " gap, " : " gaps, the largest ") +
          Rounded(largest.region.area, 2) + " " + unit;
  if (!largest.pictures.empty()) {
    line += " near " + model.images[static_cast<size_t>(largest.pictures[0])].name;
  }
  return line + ": " + CauseText(largest.region.cause) + "; a route of " +
         Rounded(result.route_length, 3) + " " + places.Unit() + " closes them" + Appended(changed);
}

}  // namespace colmap_seapoint
