// completeness_reporter: model + pictures + cloud -> what is covered, what is missing, why, and a
// way to close it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/gaps/former_report.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "densify/completeness/completeness_options.h"

namespace colmap_seapoint {

struct CompletenessReporterOptions {
  std::string image_path;   // folder of the pictures; empty: nothing is known of texture and blur
  std::string input_path;   // COLMAP model, binary or text
  std::string cloud_path;   // PLY in the model's frame
  std::string output_path;  // folder
  std::string mask_path;    // folder of COLMAP's masks; empty = none
  std::string map_path;     // folder that orthomosaic wrote, for the page; empty = none
  std::string area;         // GeoJSON of what was asked for; empty = the outline of what was imaged
  // Pictures of image_path that are in another model of the same dive: not lost, but not to be
  // placed here either. Set by the chain.
  std::vector<std::string> posed_elsewhere;
  // The report before, whose gaps are looked for again; nullopt: what lies in output_path. Set by
  // the chain, whose interrupted runs find a report there that is none before.
  std::optional<FormerReport> former;
  // Where measures of the pictures are kept between runs (facts_file.h); empty = nowhere. Set by
  // the chain.
  std::string facts_file;
  CompletenessOptions completeness;
  bool self_check = false;  // measures the tolerance (densify/self_check)
  RunOptions run;

  void Bind(OptionTable* table);
};

struct CompletenessReport {
  RunReport run;
  std::string answer;  // one line
};

// Writes index.html, completeness.json, gaps.geojson, gaps.csv, map.png (map_<layer>.png of other
// layers with gaps), run.json, and where georeferenced gaps.kml and the route for vehicles
// (route.plan, route.waypoints, route.cmp). Pictures of the model that cannot be read are left out.
// Throws Error when cloud, model, pictures and area do not belong together.
CompletenessReport ReportCompleteness(const CompletenessReporterOptions& options);

// The same; the answer on stdout.
CommandResult RunCompletenessReporter(const CompletenessReporterOptions& options);

}  // namespace colmap_seapoint
