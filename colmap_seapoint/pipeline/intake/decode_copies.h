// A folder with pictures that COLMAP does not read -> one with copies that it does.
#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/io/image/image_folder.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "colmap_seapoint/workspace/stage_runner.h"

namespace colmap_seapoint {

// Puts into the folder a JPEG "<name>.jpg" of each HEIC and RAW picture, and the other pictures
// under their own names, as links (copies where the disk knows none). A copy is made once: it is
// known by the hash of its source, and its own. Videos and what cannot be decoded are left out.
// Returns the names in the folder.
std::set<std::string> DecodeCopies(const std::filesystem::path& source,
                                   const FolderListing& listing, int num_threads,
                                   OutputFolder* folder, WorkspaceState* state, RunReport* report);

}  // namespace colmap_seapoint
