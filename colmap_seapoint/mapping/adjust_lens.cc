#include "colmap_seapoint/mapping/adjust_lens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "colmap_seapoint/adjustment/bundle_adjustment.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/mapping/retriangulate.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMinPictures = 3;
constexpr double kMaxPrincipalPointChange = 0.05;  // share of the longer side
constexpr double kMaxFocalRatio = 2.0;             // up or down
constexpr double kMaxFocalRatioOnceMore = 1.2;

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

// What became of the first camera, as one line for the user.
std::string Outcome(const SparseModel& before, const SparseModel& after) {
  const Camera& was = before.cameras.begin()->second;
  const Camera& is = after.cameras.begin()->second;
  char text[200];
  std::snprintf(text, sizeof(text),
                "focal length %.1f -> %.1f px, principal point (%.1f, %.1f) -> (%.1f, %.1f)",
                was.MeanFocal(), is.MeanFocal(), was.PrincipalX(), was.PrincipalY(),
                is.PrincipalX(), is.PrincipalY());
  return text;
}

// The adjusted model, or why the one before is better kept.
struct Adjusted {
  SparseModel model;
  std::string fault;  // empty: the model is sound
};

Adjusted AdjustSoundly(const SparseModel& before, const AdjustmentJob& job,
                       double max_focal_ratio) {
  if (before.images.size() < kMinPictures) return {{}, "too few pictures"};
  BundleAdjustmentOptions options;
  options.refine_principal_point = job.frees_principal_point;
  options.num_threads = job.num_threads;
  std::optional<SparseModel> after = AdjustBundle(options, before);
  if (!after) return {{}, "the adjustment failed"};
  const std::string fault = Fault(before, *after, max_focal_ratio);
  if (!fault.empty()) return {{}, fault};
  SortImagesById(&*after);
  return {std::move(*after), ""};
}

// The model as everybody will read it: rotations are made unit ones again by every reading.
SparseModel WrittenAndRead(const fs::path& folder, const SparseModel& model) {
  WriteSparseModelBinary(folder, model);
  return ReadSparseModel(folder);
}

std::string Refusal(const char* what, const std::string& fault) {
  return fault.empty() ? "" : std::string("; ") + what + " refused: " + fault;
}

}  // namespace

double ReprojectionError(const SparseModel& model) {
  double sum = 0;
  int64_t count = 0;
  for (const PosedImage& image : model.images) {
    const Camera& camera = model.cameras.at(image.camera_id);
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      if (image.point3D_ids[i] == kNoPoint3D) continue;
      const Eigen::Vector3d& xyz = model.points3D.at(image.point3D_ids[i]).xyz;
      const auto pixel = camera.ImgFromCam(image.cam_from_world * xyz);
      if (!pixel) continue;
      sum += (*pixel - image.points2D[i]).squaredNorm();
      ++count;
    }
  }
  return count == 0 ? 0 : std::sqrt(sum / static_cast<double>(count));
}

LensAdjustment AdjustLens(const ColmapProgram& colmap, const AdjustmentJob& job,
                          const fs::path& folder) {
  const SparseModel before = ReadSparseModel(folder);
  LensAdjustment result;
  const Adjusted first = AdjustSoundly(before, job, kMaxFocalRatio);
  const bool is_sound = first.fault.empty();
  result.distortion_is_sound = is_sound || !job.frees_distortion;
  result.model = is_sound ? WrittenAndRead(folder, first.model) : before;

  const TriangulationJob triangulation_job = {job.database_path, job.image_path, job.options,
                                              job.log_path};
  const Triangulation triangulation =
      Retriangulate(colmap, triangulation_job, folder, result.model);
  if (triangulation.model) result.model = WrittenAndRead(folder, *triangulation.model);

  Adjusted second;
  if (is_sound) {
    second = AdjustSoundly(result.model, job, kMaxFocalRatioOnceMore);
    if (second.fault.empty()) result.model = WrittenAndRead(folder, second.model);
  }
  result.outcome = Outcome(before, result.model) + Refusal("lens", first.fault) +
                   Refusal("triangulation", triangulation.fault) +
                   Refusal("second adjustment", second.fault);
  return result;
}

}  // namespace colmap_seapoint
