// Bundle adjustment of a whole model (ours): poses, points and lenses at once, so that the
// SeaPoints' reprojection errors are least.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "colmap_seapoint/adjustment/equations/bundle.h"
#include "colmap_seapoint/adjustment/equations/robust_loss.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

struct BundleAdjustmentOptions {
  bool refine_principal_point = true;
  // Standard deviation of the principal point about where it was, as a share of the picture's
  // longer side: it decides only where the pictures do not.
  double principal_point_sigma = 0.02;
  // What of a camera's lens is held or tied, by camera id; lenses that are not named are free. The
  // two options above apply to all.
  std::map<uint32_t, LensFreedom> lenses;
  std::set<uint32_t> held_images;  // image_ids: their poses stay as they are
  // The loss of the way to the minimum: convex, so that a bad start finds it.
  RobustLoss loss;
  // With the loss at the minimum. Matches that are wrong by a pixel or three are the more between
  // strips, and what they add up to bends the ground: measured with a surveyed truth (300 pictures,
  // raw from the mapper), the camera centres were off by 42 mm with soft L1 alone, by 10 with
  // Cauchy, by 6 with Geman-McClure of three standard deviations and by 9 of five. nullopt: stays
  // with `loss`.
  std::optional<LossKind> last_loss = LossKind::kGemanMcClure;
  double last_scale = 3;  // standard deviations of the residuals, as estimated (robustly) by then
  int max_num_iterations = 100;  // of each of the two
  // Where the uncertainty of a linear function of the camera centres is asked for: what each
  // picture's centre is multiplied by, one an image of the model. Empty: none is.
  std::vector<Eigen::Vector3d> centre_weights;
  int num_threads = 1;  // -1 = all cores; never changes a result
};

struct BundleAdjustment {
  SparseModel model;
  double cost = 0;         // half the sum of RobustLoss::Cost
  double error_sigma = 0;  // pixels a coordinate, by the median of all residuals
  int num_iterations = 0;
  bool is_converged = false;
  // By camera id, one for each parameter (0: held): their standard deviations, were the errors
  // independent. They are not quite: take them for a lower bound.
  std::map<uint32_t, std::vector<double>> lens_sigmas;
  // Of the function that `centre_weights` asks for, and how it goes with the lens, in the same
  // order.
  double centre_sigma = 0;
  std::map<uint32_t, std::vector<double>> centre_correlations;
};

// The model with its poses, points and lenses adjusted, and the points' errors (pixels) set anew.
// Where no pose is held nothing holds the model's frame: it may move by a trifle. What takes no
// part (bundle.h) stays where it is. nullopt when no two pictures see a common point. Prints
// progress when it takes long. The same bytes for any number of threads. About a microsecond an
// observation and iteration, 20 to 100 iterations; 200 bytes an observation beside the two models.
std::optional<BundleAdjustment> AdjustBundleInFull(const BundleAdjustmentOptions& options,
                                                   const SparseModel& model);
// The model alone.
std::optional<SparseModel> AdjustBundle(const BundleAdjustmentOptions& options,
                                        const SparseModel& model);

}  // namespace colmap_seapoint
