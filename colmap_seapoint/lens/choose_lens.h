// The form of the lens that the pictures prove (ours).
//
// Every term more lets an adjustment fit its observations better, and errors of them as well: so a
// lens is judged by observations that the adjustment has not seen.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/lens/lens_form.h"

namespace colmap_seapoint {

struct LensChoiceOptions {
  // kCentred is tried where this is kFree.
  PrincipalPoint principal_point = PrincipalPoint::kFree;
  std::map<uint32_t, double> prior_focals;  // pixels, by camera id; a weak prior of the adjustments
  int num_threads = 1;                      // -1 = all; never changes a result
};

struct LensChoice {
  LensForm form;
  // How far the ground of the forms that the pictures tell no apart is bent against one another
  // (ground_bend.h), 1 / the model's unit.
  double bend = 0;
  std::string said;  // one line: what was chosen, with the figures
};

// Adjusts the model with LensFormSteps() on the same part of its tracks, from the same start,
// and takes the simplest form that is within noise of the best; then likewise whether it has one
// focal length or two, and whether its principal point is free. Cameras that have another model
// than OPENCV, the default, are their owner's choice: where there are any, their model stays, and
// only the rest is chosen. Too few tracks prove nothing: the simplest form. The same result for any
// number of threads. Of a large model sixty pictures are asked (compact_part.h). Cost: five to nine
// adjustments of 12,000 observations.
LensChoice ChooseLens(const LensChoiceOptions& options, const SparseModel& model);

}  // namespace colmap_seapoint
