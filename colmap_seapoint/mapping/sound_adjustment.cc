#include "colmap_seapoint/mapping/sound_adjustment.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "colmap_seapoint/adjustment/bundle_adjustment.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinPictures = 3;
constexpr double kMaxPrincipalPointChange = 0.05;  // share of the longer side
constexpr double kMaxAspect = 1.01;                // of the focal lengths, up or down

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

// Those whose focal lengths were less apart before.
std::map<uint32_t, LensFreedom> LensesToTie(const SparseModel& before, const SparseModel& after) {
  std::map<uint32_t, LensFreedom> ties;
  for (const auto& [id, camera] : before.cameras) {
    const Camera& adjusted = after.cameras.at(id);
    if (!IsWithinRatio(camera.FocalX(), camera.FocalY(), kMaxAspect)) continue;
    if (IsWithinRatio(adjusted.FocalX(), adjusted.FocalY(), kMaxAspect)) continue;
    ties[id].ties_focals = true;
  }
  return ties;
}

}  // namespace

SoundAdjustment AdjustSoundly(const SparseModel& before, const LensLimits& limits) {
  if (before.images.size() < kMinPictures)
    return {{}, "it takes three pictures at least to tell the lens"};
  BundleAdjustmentOptions options;
  options.refine_principal_point = limits.frees_principal_point;
  options.num_threads = limits.num_threads;
  if (!limits.rejects_outliers) options.last_loss.reset();
  std::optional<SparseModel> after = AdjustBundle(options, before);
  if (after) {
    options.lenses = LensesToTie(before, *after);
    if (!options.lenses.empty()) after = AdjustBundle(options, before);
  }
  if (!after) return {{}, "the adjustment failed"};
  const std::string fault = Fault(before, *after, limits.max_focal_ratio);
  if (!fault.empty()) return {{}, fault};
  SortImagesById(&*after);
  return {std::move(*after), ""};
}

}  // namespace colmap_seapoint
