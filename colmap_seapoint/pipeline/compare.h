// cloud_comparer: two clouds in one frame -> how near, how complete, how dense.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/compare/compare_clouds.h"

namespace colmap_seapoint {

struct CloudComparerOptions {
  std::string input_path;       // cloud to be judged, PLY
  std::string reference_path;   // cloud to judge it by, PLY, in the same frame
  std::string output_path;      // JSON with every figure
  std::string difference_path;  // folder; empty = no difference clouds and no picture
  std::string distances;        // "0.01,0.02", units of the clouds; empty = from the spacing
  bool unit_in_metres = false;  // density per cm^2 too
  CompareOptions compare;       // without distances and num_threads, which stand above and in run
  RunOptions run;

  void Bind(OptionTable* table);
};

CommandResult RunCloudComparer(const CloudComparerOptions& options);

}  // namespace colmap_seapoint
