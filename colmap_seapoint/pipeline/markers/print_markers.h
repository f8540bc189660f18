// marker_sheet: coded markers and scale bars to print.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"

namespace colmap_seapoint {

struct PrintMarkersOptions {
  std::string output_path;  // PDF to write
  std::string family = "tag36h11";
  int first_id = 0;
  int num_markers = 4;
  double size = 0.1;      // side of the black squares, metres
  double bar_length = 0;  // of scale bars of two markers each, metres; 0 = single markers
  RunOptions run;

  void Bind(OptionTable* table);
};

// Says the rows of --scale_bars_path that belong to the print.
CommandResult RunPrintMarkers(const PrintMarkersOptions& options);

}  // namespace colmap_seapoint
