// marker_finder: pictures -> a table of the coded markers in them.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"

namespace colmap_seapoint {

struct MarkerFinderOptions {
  std::string image_path;             // folder, sub-folders included
  std::string image_list_path;        // names of the pictures to take, one a line; empty = all
  std::string output_path;            // CSV to write
  std::string families = "tag36h11";  // with commas between them
  RunOptions run;

  void Bind(OptionTable* table);
};

// Says in how many pictures each marker is.
CommandResult RunMarkerFinder(const MarkerFinderOptions& options);

}  // namespace colmap_seapoint
