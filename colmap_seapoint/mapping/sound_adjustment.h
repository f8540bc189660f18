// A model adjusted with its lens free, and whether the lens that comes out can be one (ours).
#pragma once

#include <map>
#include <set>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/lens/lens_doubt.h"
#include "colmap_seapoint/lens/lens_form.h"

namespace colmap_seapoint {

struct LensLimits {
  double max_focal_ratio = 2;  // to what it was, up or down
  // Of which the model's cameras are already; another model than the form's has no more free.
  LensForm form;
  std::map<uint32_t, double> prior_focals;  // lens_form.h
  // Observations that are far off shall count for nothing in the end; not worth its time before the
  // last adjustment.
  bool rejects_outliers = false;
  int num_threads = 1;             // -1 = all; never changes a result
  bool holds_lens = false;         // all of it: poses and points alone are adjusted
  std::set<uint32_t> held_images;  // image_ids: their poses stay as they are
};

// What a model is adjusted with before its lens is chosen: all of it is free but for a second focal
// length, which poor pictures easily feign: at an entry portal fx and fy came out 3 % apart, and
// the portal 102 mm beside its place.
LensForm FirstForm(bool frees_principal_point);

struct SoundAdjustment {
  BundleAdjustment adjustment;  // of no use where there is a fault; spread: of CurvatureWeights()
  std::string fault;  // why the model before is better kept; "" = nothing speaks against this one
};

// Adjusts poses, points and lenses (adjustment/bundle_adjustment.h). Sound is what keeps the focal
// lengths within the limits and the principal points within a twentieth of the picture's longer
// side. Pictures by their ids.
SoundAdjustment AdjustSoundly(const SparseModel& before, const LensLimits& limits);

}  // namespace colmap_seapoint
