#include "colmap_seapoint/mapping/sound_adjustment.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/lens/ground_bend.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinPictures = 3;
constexpr double kMaxPrincipalPointChange = 0.05;  // share of the longer side

bool IsWithinRatio(double after, double before, double max_ratio) {
  return after <= max_ratio * before && before <= max_ratio * after;  // false for NaN
}

// "" when the lens has changed by no more than a calibration may, else what has.
std::string LensFault(const Camera& before, const Camera& after, double max_focal_ratio) {
  if (!IsWithinRatio(after.FocalX(), before.FocalX(), max_focal_ratio) ||
      !IsWithinRatio(after.FocalY(), before.FocalY(), max_focal_ratio)) {
    return "the focal length moved too far";
  }
  const double point_change = std::hypot(after.PrincipalX() - before.PrincipalX(),
                                         after.PrincipalY() - before.PrincipalY());
  if (!(point_change <= kMaxPrincipalPointChange * std::max(before.width, before.height))) {
    return "the principal point moved too far";
  }
  return "";
}

// The same of all cameras of a model.
std::string Fault(const SparseModel& before, const SparseModel& after, double max_focal_ratio) {
  for (const auto& [id, camera] : before.cameras) {
    const std::string fault = LensFault(camera, after.cameras.at(id), max_focal_ratio);
    if (!fault.empty()) return fault;
  }
  return "";
}

}  // namespace

LensForm FirstForm(bool frees_principal_point) {
  LensForm form;
  if (!frees_principal_point) form.principal_point = PrincipalPoint::kAsItWas;
  return form;
}

SoundAdjustment AdjustSoundly(const SparseModel& before, const LensLimits& limits) {
  if (before.images.size() < kMinPictures)
    return {{}, "it takes three pictures at least to tell the lens"};
  BundleAdjustmentOptions options;
  options.lenses = limits.holds_lens ? AllLensesHeld(before)
                                     : FreedomOfLenses(limits.form, before, limits.prior_focals);
  options.held_images = limits.held_images;
  options.num_threads = limits.num_threads;
  if (!limits.rejects_outliers) options.last_loss.reset();
  if (const auto frame = FindGroundFrame(before)) {
    options.centre_weights = CurvatureWeights(before, *frame);
  }
  std::optional<BundleAdjustment> after = AdjustBundleInFull(options, before);
  if (!after) return {{}, "the adjustment failed"};
  const std::string fault = Fault(before, after->model, limits.max_focal_ratio);
  if (!fault.empty()) return {{}, fault};
  SortImagesById(&after->model);
  return {*std::move(after), ""};
}

}  // namespace colmap_seapoint
