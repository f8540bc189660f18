// cloud_exporter: a cloud -> LAS or LAZ, where it lies on the Earth.
#pragma once

#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"

namespace colmap_seapoint {

struct CloudExporterOptions {
  std::string input_path;   // PLY
  std::string output_path;  // .las or .laz
  std::string units_path;   // units.json; empty = the one beside the cloud, if there is one
  RunOptions run;

  void Bind(OptionTable* table);
};

// Coordinates are those of the units' frame: the cloud's own and the offset.
CommandResult RunCloudExporter(const CloudExporterOptions& options);

}  // namespace colmap_seapoint
