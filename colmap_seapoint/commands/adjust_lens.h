// The lens of a model that the mapper returned is adjusted once more (ours). While a model grows
// from two pictures of flat ground, a free distortion drifts off and takes the model with it; so
// the mapper holds it, and it is freed here, where all pictures have their say. Then the principal
// point, which COLMAP's mapper leaves at the picture's centre: a lens that is some pixels off bends
// the focal length by per cents on flat ground, which no dense matching can mend.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/commands/colmap_program.h"

namespace colmap_seapoint {

struct AdjustmentJob {
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  MapperOptions options;           // as the mapper had them
  std::filesystem::path log_path;  // without ".log"
  bool frees_distortion = true;
  bool frees_principal_point = true;
};

// Adjusts `model` with COLMAP, with the distortion free, triangulates it anew (retriangulate.h), and
// adjusts it with the principal point free as well. The result takes the model's place when it is sound: the same pictures, no larger
// reprojection error, focal lengths within a factor of two (the second adjustment: a fifth) and
// principal points within a twentieth of the picture's longer side of what they were.
// `colmap bundle_adjuster` gives the same result each time as long as it works with one thread,
// which it chooses itself for up to 50,000 residuals; above that it takes as many as the machine
// has cores and cannot be told otherwise (to bind it to one core does not help: three runs, three
// results). Larger models go through the mapper, which can be told.
// The model is as it was when the adjuster fails, or returns something unsound.
struct LensAdjustment {
  bool distortion_is_sound = true;  // it was freed and the result taken, or it was free before
  std::string outcome;              // one line for the user
};
LensAdjustment AdjustLens(const ColmapProgram& colmap, const AdjustmentJob& job,
                          const std::filesystem::path& model);

// Root mean square over all observations of triangulated points, pixels.
double ReprojectionError(const SparseModel& model);

}  // namespace colmap_seapoint
