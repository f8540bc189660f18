// A cloud comparison as JSON and as a table.
#pragma once

#include <string>

#include "colmap_seapoint/compare/cloud_comparison.h"

namespace colmap_seapoint {

struct ComparisonReport {
  std::string input_path, reference_path;
  bool unit_in_metres = false;
  CloudComparison comparison;
};

// Every figure with its definition beside it; figures that do not exist are null. Holds
// kComparisonJsonWords near its beginning, as nobody else's file does.
inline constexpr char kComparisonJsonWords[] = "spacing_of_points";
std::string ComparisonJson(const ComparisonReport& report);

// The same for a person, on one screen.
std::string ComparisonTable(const ComparisonReport& report);

}  // namespace colmap_seapoint
