#include "colmap_seapoint/commands/adjust_lens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/commands/adjust_by_mapper.h"
#include "colmap_seapoint/commands/retriangulate.h"
#include "colmap_seapoint/io/colmap_model.h"
#include "colmap_seapoint/io/subprocess.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMinPictures = 3;
constexpr double kMaxErrorGrowth = 1.001;         // the adjuster's cost is robust, ours is not
constexpr double kMaxErrorGrowthOfMapper = 1.02;  // which takes observations in and out
// With two residuals each, below COLMAP's 50,000 (BundleAdjustmentOptions).
constexpr size_t kMaxObservationsOfAdjuster = 24000;
constexpr char kMaxIterations[] = "300";           // 50 or 100 in COLMAP: it stops on the way
constexpr double kMaxPrincipalPointChange = 0.05;  // share of the longer side

struct Adjustment {
  const char* name;
  bool frees_principal_point;
  double max_focal_ratio;  // or its inverse
};
constexpr Adjustment kDistortion = {"distortion", false, 2.0};
constexpr Adjustment kPrincipalPoint = {"principal_point", true, 1.2};

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

std::string Fault(const SparseModel& before, const SparseModel& after, double max_focal_ratio,
                  double max_error_growth) {
  if (after.images.size() != before.images.size() ||
      after.cameras.size() != before.cameras.size()) {
    return "pictures were lost";
  }
  for (const auto& [id, camera] : before.cameras) {
    const auto found = after.cameras.find(id);
    if (found == after.cameras.end()) return "a camera was lost";
    const std::string fault = LensFault(camera, found->second, max_focal_ratio);
    if (!fault.empty()) return fault;
  }
  if (ReprojectionError(after) > max_error_growth * ReprojectionError(before)) {
    return "the error grew";
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

// The bundle adjuster leaves the points' errors as they were before it.
void UpdatePointErrors(SparseModel* model) {
  std::map<uint64_t, double> sums;
  for (const PosedImage& image : model->images) {
    const Camera& camera = model->cameras.at(image.camera_id);
    for (size_t i = 0; i < image.points2D.size(); ++i) {
      const uint64_t id = image.point3D_ids[i];
      if (id == kNoPoint3D) continue;
      const auto pixel = camera.ImgFromCam(image.cam_from_world * model->points3D.at(id).xyz);
      if (pixel) sums[id] += (*pixel - image.points2D[i]).norm();
    }
  }
  for (auto& [id, point] : model->points3D) {
    if (!point.track.empty()) point.error = sums[id] / static_cast<double>(point.track.size());
  }
}

size_t NumObservations(const SparseModel& model) {
  size_t count = 0;
  for (const auto& [id, point] : model.points3D) count += point.track.size();
  return count;
}

SubprocessResult RunBundleAdjuster(const ColmapProgram& colmap, const Adjustment& adjustment,
                                   const fs::path& model, const fs::path& output,
                                   const fs::path& log) {
  return RunSubprocess(
      colmap.path,
      {"bundle_adjuster", "--input_path", model.string(), "--output_path", output.string(),
       "--BundleAdjustment.refine_principal_point", adjustment.frees_principal_point ? "1" : "0",
       "--BundleAdjustment.max_num_iterations", kMaxIterations},
      log, {});
}

SubprocessResult RunMapperAgain(const ColmapProgram& colmap, const AdjustmentJob& job,
                                const Adjustment& adjustment, const SparseModel& model,
                                const fs::path& output, const fs::path& log) {
  MapperOptions options = job.options;
  options["Mapper.ba_refine_extra_params"] = "1";
  options["Mapper.ba_refine_principal_point"] = adjustment.frees_principal_point ? "1" : "0";
  options["Mapper.ba_global_max_num_iterations"] = kMaxIterations;
  return AdjustByMapper(colmap, model, {job.database_path, job.image_path, options, output, log});
}

// "" when the adjusted model has taken the model's place; else why not.
std::string Adjust(const ColmapProgram& colmap, const AdjustmentJob& job,
                   const Adjustment& adjustment, const fs::path& model) {
  const SparseModel before = ReadSparseModel(model);
  if (before.images.size() < kMinPictures) return "too few pictures";
  const bool by_mapper = NumObservations(before) > kMaxObservationsOfAdjuster;
  const fs::path adjusted = model.string() + ".adjusted";
  const fs::path log = job.log_path.string() + "_" + adjustment.name + ".log";
  std::error_code error;
  fs::remove_all(adjusted, error);
  fs::create_directories(adjusted);
  const auto result = by_mapper ? RunMapperAgain(colmap, job, adjustment, before, adjusted, log)
                                : RunBundleAdjuster(colmap, adjustment, model, adjusted, log);
  std::string fault;
  if (!result.Succeeded() || !IsSparseModel(adjusted)) {
    fault = "the adjustment failed (" + result.Text() + ")";
  } else {
    SparseModel after = ReadSparseModel(adjusted);
    UpdatePointErrors(&after);
    fault = Fault(before, after, adjustment.max_focal_ratio,
                  by_mapper ? kMaxErrorGrowthOfMapper : kMaxErrorGrowth);
    if (fault.empty()) WriteSparseModelBinary(model, after);
  }
  fs::remove_all(adjusted, error);
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
  LensAdjustment result;
  std::string refused;
  const auto adjust = [&](const Adjustment& adjustment) {
    const std::string fault = Adjust(colmap, job, adjustment, model);
    if (!fault.empty()) refused += std::string("; ") + adjustment.name + " refused: " + fault;
    return fault.empty();
  };
  if (job.frees_distortion) result.distortion_is_sound = adjust(kDistortion);
  const std::string fault = Retriangulate(
      colmap, {job.database_path, job.image_path, job.options, job.log_path}, model);
  if (!fault.empty()) refused += "; triangulation refused: " + fault;
  // It frees the distortion too.
  if (job.frees_principal_point && result.distortion_is_sound) adjust(kPrincipalPoint);
  result.outcome = Outcome(before, ReadSparseModel(model)) + refused;
  return result;
}

}  // namespace colmap_seapoint
