// --rig: which pictures a stereo rig took at the same moment (paper 4).
#pragma once

#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/base/stereo_rig.h"

namespace colmap_seapoint {

// Help text of --rig, which more than one command has.
extern const char kRigHelp[];

// "" for a legal value of --rig ("", "none", "LEFT,RIGHT"), else what is wrong with it.
std::string CheckRig(const std::string& rig);

// Throws Error when `rig` names folders that are not there, or in which no picture has a
// simultaneous one. Cheap: lists two folders.
void CheckRigFolders(const std::string& rig, const std::string& image_path);

// "LEFT,RIGHT": from the names in these folders; warns when the model holds no simultaneous
// pictures. "": from the model's frames, if it has any; damaged ones are as good as none, and a
// warning says so. "none": no rig. Throws as CheckRigFolders.
StereoRig ReadRig(const std::string& rig, const std::string& image_path,
                  const std::string& model_path, const SparseModel& model);

}  // namespace colmap_seapoint
