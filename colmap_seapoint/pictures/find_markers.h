// The coded markers in the pictures of a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/files/markers_csv.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/markers/marker_name.h"

namespace colmap_seapoint {

// In the order of `names` (relative to `image_path`). Pictures that cannot be read are left out, by
// name. The same for any number of threads.
std::vector<MarkerSighting> FindMarkers(const std::filesystem::path& image_path,
                                        const std::vector<std::string>& names,
                                        const std::vector<MarkerFamily>& families, int num_threads,
                                        RunReport* report);

}  // namespace colmap_seapoint
