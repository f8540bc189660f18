// The lens of a model that the mapper returned is adjusted once more (ours).
//
// While a model grows from two pictures of flat ground, a free distortion drifts off and takes the
// model with it; so the mapper holds it, and it is freed here, where all pictures have their say.
// The principal point is freed with it, which COLMAP's mapper leaves at the picture's centre: one
// that is some pixels off bends the focal length by per cents on flat ground, which no dense
// matching can mend.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/mapping/colmap_program.h"

namespace colmap_seapoint {

struct AdjustmentJob {
  std::filesystem::path database_path;
  std::filesystem::path image_path;
  std::string mask_path;           // COLMAP's masks (picture_masks.h); empty = none
  MapperOptions options;           // as the mapper had them
  std::filesystem::path log_path;  // without "_triangulation.log"
  bool must_succeed = false;       // the triangulation (retriangulate.h)
  bool holds_lens = false;         // poses and points alone are adjusted
  bool frees_distortion = true;    // false: the mapper had it free already
  bool frees_principal_point = true;
  std::map<uint32_t, double> prior_focals;  // PriorFocals() of the database
  int num_threads = 1;
};

struct LensAdjustment {
  bool is_usable = true;  // false: the triangulation failed, and nothing else counts
  SparseModel model;      // as `folder` holds it afterwards
  // The distortion was freed here and the result taken, or the mapper had it free already.
  bool distortion_is_sound = true;
  // Pictures whose verified matches contradict the pose that they have in the end
  // (reposing/match_agreement.h).
  size_t num_contradicted = 0;
  std::string outcome;  // one line for the user
};

// What the pictures' cameras say of their focal lengths, or what was guessed, pixels by camera id;
// empty where there is no such database.
std::map<uint32_t, double> PriorFocals(const std::filesystem::path& database_path);

// Adjusts the model in `folder` with all of the lens free (sound_adjustment.h), triangulates
// it anew (retriangulate.h), brings back pictures that then stand wrong
// (reposing/repose_pictures.h), measures its observations again in the pictures
// (remeasuring/remeasure_observations.h), chooses the form of the lens that they prove
// (lens/choose_lens.h) and adjusts it once more with that; what is taken is written back at each
// step. An adjustment is taken when it is sound: focal lengths within a factor of two of what they
// were, the second time of 1.2. When the first one is not, the model keeps its lens. To hold the
// principal point and try again would hide that the model is wrong: on the amphora wreck, where the
// mapper's trial with a held distortion had fallen into a lens of 122 px, it gave 183 px instead of
// 1090. Throws Error when the model cannot be read or written. The same model for any number of
// threads.
LensAdjustment AdjustLens(const ColmapProgram& colmap, const AdjustmentJob& job,
                          const std::filesystem::path& folder);

// Root mean square over all observations of triangulated points, pixels; 0 when there is none.
double ReprojectionError(const SparseModel& model);

}  // namespace colmap_seapoint
