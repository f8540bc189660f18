// Bundle adjustment of a whole model (ours, with Ceres): poses, points and lenses at once, so that
// the SeaPoints' reprojection errors are least.
//
// Why not COLMAP's own: `colmap bundle_adjuster` takes as many threads as the machine has cores
// once a model has more than 50,000 residuals, and then returns another result on every run; and
// the mapper's, which can be told to use one, takes observations in and out between its rounds, so
// that nothing says whether the lens that it ends with is the better one.
#pragma once

#include <optional>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

struct BundleAdjustmentOptions {
  bool refine_principal_point = true;
  // Pixels. An error below it counts by its square, one far above it only by its size: soft L1,
  // which takes a third of the iterations of Cauchy's loss and gives the same lens.
  double observation_sigma = 0.5;
  // Standard deviation of the principal point about where it was, as a share of the picture's
  // longer side: it decides only where the pictures do not.
  double principal_point_sigma = 0.02;
  int max_num_iterations = 300;
};

// The model with its poses, points and all parameters of its cameras adjusted (the principal point
// only when told so), and the points' errors (pixels) set anew. Nothing holds the model's frame: it
// may move by a trifle, and the solver needs a third fewer steps along the curved valley where
// focal length, distortion and the bend of the ground trade places. Observations behind their
// camera are passed over. nullopt when there is no observation or the solver fails. One thread, the
// same bytes every time. About 3 microseconds an observation and iteration; 10 to 70 iterations.
std::optional<SparseModel> AdjustBundle(const BundleAdjustmentOptions& options,
                                        const SparseModel& model);

}  // namespace colmap_seapoint
