// What earlier versions made, which kept no list of it (output_folder.h): told by what they left.
#pragma once

#include <filesystem>

#include "colmap_seapoint/io/outputs/output_folder.h"

namespace colmap_seapoint {

// A workspace of automatic_reconstructor that has no list of ours but records of finished stages in
// state/. Ours is what these say was done: the database when its stage was, the models when
// that, or a later stage, was. What no record proves stays the user's.
void AdoptEarlierWorkspace(OutputFolder* workspace);

// A folder of one command's outputs that has no list of ours but a run.json of partial_densifier or
// of model_scaler, or the clouds of cloud_comparer: the files that these wrote.
void AdoptEarlierOutputs(OutputFolder* folder);

// Removes what a command of any version made in its folder below a workspace, and the folder if
// nothing else is in it.
void RemoveOutputs(const std::filesystem::path& folder);

}  // namespace colmap_seapoint
