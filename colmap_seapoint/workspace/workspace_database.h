// The workspace's database follows its inputs: what an interrupted run computed is kept exactly as
// long as an uninterrupted run would compute the same.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "colmap_seapoint/workspace/stage_runner.h"

namespace colmap_seapoint {

// What a database is begun with, SeaPoints apart.
struct DatabaseInputs {
  std::string options;                // of cameras and matching
  std::vector<std::string> pictures;  // a line each: name, size, camera
};

// Opens WORKSPACE/database.db in a state from which extraction and matching go on: as it is when
// `stage` (of pictures, cameras and matching) is the one it was begun with, and when pictures came
// in since its models were finished, with the same options, and none has gone or changed (their
// rows are added, under new ids, by the extraction); otherwise begun anew, with the SeaPoints of
// pictures that are still there. One connection serves the whole chain. `inputs` are remembered for
// the next time. Throws Error when the workspace holds a database that is not ours.
ColmapDatabase OpenWorkspaceDatabase(const std::filesystem::path& database_path,
                                     const std::vector<ReadablePicture>& pictures,
                                     const ImageReaderOptions& reader, const Stage& stage,
                                     const DatabaseInputs& inputs, WorkspaceState* state);

// A hash of the images, the cameras, and what the SeaPoints were made from.
std::string DatabaseFingerprint(const ColmapDatabase& database);

}  // namespace colmap_seapoint
