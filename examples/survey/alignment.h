// The similarity that brings an estimated model into the truth's frame.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "examples/survey/scene/surface.h"

namespace colmap_seapoint {

struct CentreAlignment {
  Similarity3d truth_from_model;
  int num_registered = 0;
  double rms = 0, max = 0;  // of what is left between the centres, metres
};

// Umeyama on the camera centres of pictures with the same name. When these lie on one line (a
// single strip), which leaves a turn about it open, the rotation comes from the cameras' own
// attitudes. With `identity` only the errors are computed. Throws Error for fewer than 3 pictures
// in common, or centres that all coincide.
CentreAlignment AlignCentres(const SparseModel& truth, const SparseModel& model, bool identity);

// Moves on from `start` by point-to-plane iterations of the points (model's frame; a subset is
// used) onto the ground; points farther than `reach` metres do not pull.
Similarity3d RefineOnSurface(const Surface& surface, const std::vector<Eigen::Vector3f>& points,
                             const Similarity3d& start, double reach);

}  // namespace colmap_seapoint
