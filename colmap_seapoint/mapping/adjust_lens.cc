#include "colmap_seapoint/mapping/adjust_lens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/mapping/bundle_adjustment.h"
#include "colmap_seapoint/mapping/retriangulate.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMinPictures = 3;
constexpr double kMaxPrincipalPointChange = 0.05;  // share of the longer side
constexpr double kMaxFocalRatio = 2.0;             // or its inverse
constexpr double kMaxFocalRatioOnceMore = 1.2;

bool IsWithinRatio(double after, double before, double max_ratio) {
  return after <= max_ratio * before && before <= max_ratio * after;  // false for NaN
}

// "" when the lens has changed by no more than a calibration may.
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

std::string Fault(const SparseModel& before, const SparseModel& after, double max_focal_ratio) {
  for (const auto& [id, camera] : before.cameras) {
    const std::string fault = LensFault(camera, after.cameras.at(id), max_focal_ratio);
    if (!fault.empty()) return fault;
  }
  return "";
}

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

// "" when the adjusted model has taken the model's place; else why not.
std::string Adjust(bool frees_principal_point, double max_focal_ratio, const fs::path& model) {
  const SparseModel before = ReadSparseModel(model);
  if (before.images.size() < kMinPictures) return "too few pictures";
  BundleAdjustmentOptions options;
  options.refine_principal_point = frees_principal_point;
  SparseModel after = before;
  if (!AdjustBundle(options, &after)) return "the adjustment failed";
  const std::string fault = Fault(before, after, max_focal_ratio);
  if (!fault.empty()) return fault;
  SortImagesById(&after);
  WriteSparseModelBinary(model, after);
  return fault;
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
                          const fs::path& model) {
  const SparseModel before = ReadSparseModel(model);
  std::string refused;
  const auto refuse = [&](const char* what, const std::string& fault) {
    if (!fault.empty()) refused += std::string("; ") + what + " refused: " + fault;
  };
  const std::string fault = Adjust(job.frees_principal_point, kMaxFocalRatio, model);
  refuse("lens", fault);
  LensAdjustment result;
  result.distortion_is_sound = fault.empty() || !job.frees_distortion;
  refuse(
      "triangulation",
      Retriangulate(colmap, {job.database_path, job.image_path, job.options, job.log_path}, model));
  if (fault.empty()) {
    refuse("second adjustment", Adjust(job.frees_principal_point, kMaxFocalRatioOnceMore, model));
  }
  result.outcome = Outcome(before, ReadSparseModel(model)) + refused;
  return result;
}

}  // namespace colmap_seapoint
