// The lens of a model that the mapper returned is adjusted once more (ours). While a model grows
// from two pictures of flat ground, a free distortion drifts off and takes the model with it; so
// the mapper holds it, and it is freed here, where all pictures have their say; with it the
// principal point, which COLMAP's mapper leaves at the picture's centre: a lens that is some pixels
// off bends the focal length by per cents on flat ground, which no dense matching can mend.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/mapping/colmap_program.h"

namespace colmap_seapoint {

struct AdjustmentJob {
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  MapperOptions options;           // as the mapper had them
  std::filesystem::path log_path;  // without ".log"
  bool frees_distortion = true;
  bool frees_principal_point = true;
};

// Adjusts `model` with all of the lens free (bundle_adjustment.h), triangulates it anew
// (retriangulate.h), and adjusts it once more. Distortion and principal point are freed together:
// held at the picture's centre, a principal point that is a few pixels off draws the focal length
// off by a per cent. An adjustment is taken when it is sound: focal lengths within a factor of two
// (the second time: a fifth) and principal points within a twentieth of the picture's longer side
// of what they were. When it is not, the model keeps its lens: to hold the principal point instead
// would hide that the model is wrong (183 px instead of 1090 on the amphora wreck, where the
// mapper's trial with a held distortion had fallen into a lens of 122 px). One thread: the same
// model each time.
struct LensAdjustment {
  bool distortion_is_sound = true;  // it was freed and the result taken, or it was free before
  std::string outcome;              // one line for the user
};
LensAdjustment AdjustLens(const ColmapProgram& colmap, const AdjustmentJob& job,
                          const std::filesystem::path& model);

// Root mean square over all observations of triangulated points, pixels.
double ReprojectionError(const SparseModel& model);

}  // namespace colmap_seapoint
