// The tables of the densification benchmark (paper 3, Tables 2 and 3) from its rows.
#pragma once

#include <string>
#include <vector>

#include "examples/benchmarks/densify/densify_rows.h"

namespace colmap_seapoint {

struct DensifyResults {
  std::vector<DensifyRow> rows;
  std::vector<HoldOutRow> hold_outs;
  std::vector<ProgramRow> programs;
};

// What every column means.
std::string DensifyDefinitions();
// Markdown; tables without a row are left out.
std::string DensifyTables(const DensifyResults& results);
// Tab-separated for gnuplot: a line a set, a column a variant and figure; "?" where unknown.
std::string DensifyPlotData(const std::vector<DensifyRow>& rows);

}  // namespace colmap_seapoint
