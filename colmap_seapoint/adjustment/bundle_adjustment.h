// Bundle adjustment of a whole model (ours): poses, points and lenses at once, so that the
// SeaPoints' reprojection errors are least.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "colmap_seapoint/adjustment/bundle.h"
#include "colmap_seapoint/adjustment/robust_loss.h"
#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

struct BundleAdjustmentOptions {
  bool refine_principal_point = true;
  double principal_point_sigma = 0.02;
  std::map<uint32_t, LensFreedom> lenses;
  RobustLoss loss;
  std::optional<LossKind> last_loss;
  double last_scale = 2;
  int max_num_iterations = 100;
  int num_threads = 1;
};

struct BundleAdjustment {
  SparseModel model;
  double cost = 0;
  double error_sigma = 0;
  int num_iterations = 0;
  bool is_converged = false;
  std::map<uint32_t, std::vector<double>> lens_sigmas;
};

std::optional<BundleAdjustment> AdjustBundleInFull(const BundleAdjustmentOptions& options,
                                                   const SparseModel& model);
std::optional<SparseModel> AdjustBundle(const BundleAdjustmentOptions& options,
                                        const SparseModel& model);

}  // namespace colmap_seapoint
