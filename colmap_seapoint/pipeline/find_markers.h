// marker_finder: pictures -> a table of the coded markers in them. The same as a stage of
// automatic_reconstructor.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/files/markers_csv.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/markers/marker_name.h"
#include "colmap_seapoint/pipeline/stage_runner.h"
#include "colmap_seapoint/pipeline/workspace.h"

namespace colmap_seapoint {

struct MarkerFinderOptions {
  std::string image_path;             // folder, sub-folders included
  std::string image_list_path;        // names of the pictures to take, one a line; empty = all
  std::string output_path;            // CSV to write
  std::string families = "tag36h11";  // with commas between them
  RunOptions run;

  void Bind(OptionTable* table);
};

// In the order of `names` (relative to `image_path`). Pictures that cannot be read are left out, by
// name. The same for any number of threads.
std::vector<MarkerSighting> FindMarkers(const std::filesystem::path& image_path,
                                        const std::vector<std::string>& names,
                                        const std::vector<MarkerFamily>& families, int num_threads,
                                        RunReport* report);

// What automatic_reconstructor looks for, and in which pictures.
struct MarkerSearch {
  std::vector<MarkerFamily> families;  // empty: nothing is looked for
  std::vector<RunReport::Input> pictures;
  int num_threads = -1;
};

// The stage "markers" of a workspace: found_markers.csv, made once for the same pictures and
// families. Without families, what an earlier run made is removed. Returns what was found.
std::vector<MarkerSighting> FindMarkersOnce(const MarkerSearch& search, const Workspace& workspace,
                                            WorkspaceState* state, RunReport* report);

CommandResult RunMarkerFinder(const MarkerFinderOptions& options);

}  // namespace colmap_seapoint
