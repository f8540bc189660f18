#include "colmap_seapoint/mapping/adjust_lens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/mapping/retriangulate.h"
#include "colmap_seapoint/mapping/sound_adjustment.h"
#include "colmap_seapoint/remeasuring/remeasure_observations.h"
#include "feature/remeasuring/patch_matching.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr size_t kFirmObservations = 100;
constexpr double kMaxFocalRatioOnceMore = 1.2;

// What became of the first camera, as one line for the user.
std::string Outcome(const Camera& was, const Camera& is) {
  char text[200];
  std::snprintf(text, sizeof(text),
                "focal length %.1f -> %.1f px, principal point (%.1f, %.1f) -> (%.1f, %.1f)",
                was.MeanFocal(), is.MeanFocal(), was.PrincipalX(), was.PrincipalY(),
                is.PrincipalX(), is.PrincipalY());
  return text;
}

size_t NumObservations(const PosedImage& image) {
  return image.point3D_ids.size() -
         static_cast<size_t>(
             std::count(image.point3D_ids.begin(), image.point3D_ids.end(), kNoPoint3D));
}

// The model as everybody will read it: rotations are made unit ones again by every reading.
SparseModel WrittenAndRead(const fs::path& folder, SparseModel model) {
  WriteSparseModelBinary(folder, model);
  model = SparseModel();
  return ReadSparseModel(folder);
}

// Whether each picture keeps half of its observations, or as many as hold it firmly.
bool HoldsFirmly(const SparseModel& before, const SparseModel& after) {
  for (size_t i = 0; i < before.images.size(); ++i) {
    const size_t num_left = NumObservations(after.images[i]);
    if (num_left < kFirmObservations && 2 * num_left < NumObservations(before.images[i])) {
      return false;
    }
  }
  return true;
}

// The model with its observations measured again in the pictures: those that are known best where
// they are enough, else those that are known at all; nullopt where neither are.
std::optional<SparseModel> MeasuredAgain(const SparseModel& model, const AdjustmentJob& job) {
  RemeasuringOptions options;
  options.num_threads = job.num_threads;
  const auto read = [&](const PosedImage& image) {
    return ReadGrayImage(job.image_path / image.name);
  };
  for (const double max_sigma : {options.max_sigma, kMaxPatchSigma}) {
    options.max_sigma = max_sigma;
    Remeasurement measured = RemeasureObservations(options, model, read);
    if (HoldsFirmly(model, measured.model)) return std::move(measured.model);
  }
  return std::nullopt;
}

std::string Refusal(const char* what, const std::string& fault) {
  return fault.empty() ? "" : std::string("; ") + what + " kept as the mapper left it: " + fault;
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

// A model takes gigabytes where there are thousands of pictures: at most two are held at a time.
LensAdjustment AdjustLens(const ColmapProgram& colmap, const AdjustmentJob& job,
                          const fs::path& folder) {
  LensAdjustment result;
  result.model = ReadSparseModel(folder);
  const Camera lens_before = result.model.cameras.begin()->second;
  LensLimits limits;
  limits.frees_principal_point = job.frees_principal_point;
  limits.num_threads = job.num_threads;
  SoundAdjustment first = AdjustSoundly(result.model, limits);
  const bool is_sound = first.fault.empty();
  result.distortion_is_sound = is_sound || !job.frees_distortion;
  if (is_sound) result.model = WrittenAndRead(folder, std::move(first.model));

  const TriangulationJob triangulation_job = {job.database_path, job.image_path, job.options,
                                              job.log_path};
  Triangulation triangulation = Retriangulate(colmap, triangulation_job, folder, result.model);
  if (triangulation.model) result.model = WrittenAndRead(folder, *std::move(triangulation.model));

  SoundAdjustment second;
  if (is_sound) {
    if (auto measured = MeasuredAgain(result.model, job)) result.model = *std::move(measured);
    limits.max_focal_ratio = kMaxFocalRatioOnceMore;
    limits.rejects_outliers = true;
    second = AdjustSoundly(result.model, limits);
    result.model = second.fault.empty() ? WrittenAndRead(folder, std::move(second.model))
                                        : ReadSparseModel(folder);
  }
  result.outcome = Outcome(lens_before, result.model.cameras.begin()->second) +
                   Refusal("lens", first.fault) + Refusal("triangulation", triangulation.fault) +
                   Refusal("second adjustment", second.fault);
  return result;
}

}  // namespace colmap_seapoint
