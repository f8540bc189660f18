// rigs and frames of a model of COLMAP 3.12 and later, kept consistent when the model moves.
#pragma once

#include <filesystem>

#include "colmap_seapoint/base/similarity3.h"

namespace colmap_seapoint {

// Which files a model in `dir` is read from: binary is preferred when both exist.
bool IsBinaryModel(const std::filesystem::path& dir);

// Removes rigs and frames, in either form, of a model whose pictures have been posed one by one:
// from 3.12 on COLMAP takes the poses of frames, not those of images, where there are frames, and
// makes frames by itself where there are none. Throws Error when one cannot be removed.
void RemoveRigFiles(const std::filesystem::path& dir);

// Writes rigs and frames of the model in `from` (.bin or .txt, as IsBinaryModel says; neither need
// be there) into `to`, in the new world: rig_from_world follows, and the translations of
// sensor_from_rig take the scale. All else keeps its bytes (binary) or words (text). Throws Error
// naming file and byte or line when one is damaged.
void TransformRigFiles(const std::filesystem::path& from, const std::filesystem::path& to,
                       const Similarity3d& new_from_old);

}  // namespace colmap_seapoint
