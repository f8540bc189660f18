// cloud_merger: clouds of the blocks of one survey (partial_densifier --block) -> one, without what
// two of them show.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"

namespace colmap_seapoint {

struct CloudMergerOptions {
  std::string input_path;   // PLY, separated by commas, all in one frame
  std::string output_path;  // PLY
  double spacing = 0;       // of the points, units of the clouds; 0 = as the first cloud has it
  RunOptions run;

  void Bind(OptionTable* table);
};

// The points of the first cloud, and of each further one those that lie beside no point of the
// clouds before it (KnownPlaces), in their order; with the pictures of each point in OUT.ply.vis
// where all clouds have such. Clouds are streamed: 8 bytes a place are in memory. Throws UsageError
// for fewer than two clouds and for one that is the output, Error for what cannot be read or
// written.
CommandResult RunCloudMerger(const CloudMergerOptions& options);

}  // namespace colmap_seapoint
