// What later stages were told of the pictures of a model, so that it can be seen whether a model
// holds these pictures still, and more behind them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/image/picture_masks.h"

namespace colmap_seapoint {

// Of the model in `path`, a line a picture in its order: its name, and a hash of its pose, camera
// and mask.
std::vector<std::string> PosedPictureLines(const std::filesystem::path& path,
                                           const PictureMasks& masks);

// Whether `lines` begin with `first`.
bool BeginWith(const std::vector<std::string>& lines, const std::vector<std::string>& first);

}  // namespace colmap_seapoint
