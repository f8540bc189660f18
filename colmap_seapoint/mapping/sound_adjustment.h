// A model adjusted with its lens free, and whether the lens that comes out can be one (ours).
#pragma once

#include <string>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

struct LensLimits {
  double max_focal_ratio = 2;  // to what it was, up or down
  bool frees_principal_point = true;
  // Observations that are far off shall count for nothing in the end; not worth its time before the
  // last adjustment.
  bool rejects_outliers = false;
  int num_threads = 1;      // -1 = all; never changes a result
  bool holds_lens = false;  // all of it: poses and points alone are adjusted
};

struct SoundAdjustment {
  SparseModel model;  // of no use where there is a fault
  std::string fault;  // why the model before is better kept; "" = nothing speaks against this one
};

// Adjusts poses, points and lenses (adjustment/bundle_adjustment.h). Sound is what keeps the focal
// lengths within the limits and the principal points within a twentieth of the picture's longer
// side. A lens has one focal length until the pictures prove two: where fx and fy come out more
// than a hundredth apart, which no lens of ours has and poor pictures easily feign, the model is
// adjusted once more with both the same. Pictures by their ids.
SoundAdjustment AdjustSoundly(const SparseModel& before, const LensLimits& limits);

}  // namespace colmap_seapoint
