// One more adjustment of a model that the mapper returned, with the principal point free (ours).
// COLMAP's mapper holds it at the picture's centre; a lens that is some pixels off then bends the
// focal length by per cents on flat ground, which no dense matching can mend.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/commands/colmap_program.h"

namespace colmap_seapoint {

struct AdjustmentJob {
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  MapperOptions options;  // as the mapper had them
  std::filesystem::path log_path;
};

// Takes one picture out of `model`, has `colmap mapper` register it again, which ends with a global
// adjustment, and puts the result in the model's place when it is sound: the same pictures, no
// larger reprojection error, focal lengths within a fifth and principal points within a twentieth
// of the picture's longer side of what they were. Not `colmap bundle_adjuster`: with many points it
// uses all cores, cannot be told not to, and then gives another result each time.
// Returns what happened, one line; the model is as it was when the mapper fails, or returns
// something unsound.
std::string AdjustPrincipalPoint(const ColmapProgram& colmap, const AdjustmentJob& job,
                                 const std::filesystem::path& model);

}  // namespace colmap_seapoint
