// orthomosaic: model + pictures + cloud -> relief and true orthomosaic on one grid, as GeoTIFFs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pipeline/orthomosaic/former_map.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_settings.h"

namespace colmap_seapoint {

struct OrthomosaicMakerOptions {
  std::string image_path;   // folder of the pictures
  std::string input_path;   // COLMAP model, binary or text
  std::string cloud_path;   // PLY in the model's frame
  std::string output_path;  // folder
  std::string mask_path;    // folder of COLMAP's masks; empty = none
  MapSettings map;
  RunOptions run;
  // Set by the chain.
  std::optional<FormerMap> former;    // the map that is continued
  std::filesystem::path memory_path;  // gets what continues this one; empty: nothing does

  void Bind(OptionTable* table);
};

struct MadeMap {
  RunReport report;
  std::string line;  // what the map is like
};

// Writes orthomosaic.tif, dem.tif, source.tif with source.csv, surface.tif, hillshade.png,
// orthomosaic.jpg, map.json and run.json. Pictures that cannot be read, or whose masks cannot be
// used, are left out and named. Throws UsageError, NoMap and Error.
MadeMap MakeMap(const OrthomosaicMakerOptions& options);

// The same as a command; incomplete when pictures were left out.
CommandResult RunOrthomosaic(const OrthomosaicMakerOptions& options);

}  // namespace colmap_seapoint
