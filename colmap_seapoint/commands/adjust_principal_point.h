// One more bundle adjustment of a model that the mapper returned, with the principal point free
// (ours). COLMAP's mapper holds it at the picture's centre; a lens that is some pixels off then
// bends the focal length by per cents on flat ground, which no dense matching can mend.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/commands/colmap_program.h"

namespace colmap_seapoint {

// Runs `colmap bundle_adjuster` on `model` and puts the result in its place when it is sound: the
// same pictures, no larger reprojection error, focal lengths within a fifth and principal points
// within a twentieth of the picture's longer side of what they were. Returns what happened, one
// line; the model is as it was when the adjuster is missing, fails, or returns something unsound.
std::string AdjustPrincipalPoint(const ColmapProgram& colmap, const std::filesystem::path& model,
                                 const std::filesystem::path& log_path);

}  // namespace colmap_seapoint
