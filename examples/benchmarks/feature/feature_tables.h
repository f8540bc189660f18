// The feature benchmark's tables: medians over the pairs of a set.
#pragma once

#include <string>
#include <vector>

#include "examples/benchmarks/feature/feature_rows.h"

namespace colmap_seapoint {

// Markdown: how the values are defined, then one row a set and detector in each of three tables
// (matching; CPU time; against the truth, when a set has one).
std::string MarkdownTables(const std::vector<FeatureRow>& rows);

// For gnuplot: one line a set, tab between the columns, first line: their names
// ("matched_2 SeaPoints" is the matched share of (V, V+2) in percent). "?" where nothing is known.
std::string PlotData(const std::vector<FeatureRow>& rows);

}  // namespace colmap_seapoint
