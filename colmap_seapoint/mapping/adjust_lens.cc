#include "colmap_seapoint/mapping/adjust_lens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/lens/choose_lens.h"
#include "colmap_seapoint/lens/ground_bend.h"
#include "colmap_seapoint/lens/lens_doubt.h"
#include "colmap_seapoint/mapping/measure_again.h"
#include "colmap_seapoint/mapping/retriangulate.h"
#include "colmap_seapoint/mapping/sound_adjustment.h"
#include "colmap_seapoint/remeasuring/extend_tracks.h"
#include "colmap_seapoint/reposing/match_agreement.h"
#include "colmap_seapoint/reposing/repose_pictures.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

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

// The model as everybody will read it: rotations are made unit ones again by every reading.
SparseModel WrittenAndRead(const fs::path& folder, SparseModel model) {
  WriteSparseModelBinary(folder, model);
  model = SparseModel();
  return ReadSparseModel(folder);
}

ColmapDatabase OpenedToRead(const fs::path& path) {
  return ColmapDatabase(path, ColmapDatabase::Mode::kReadOnly, ColmapDatabase::Check::kNone);
}

// Brings the pictures that stand wrong to where they belong, in the folder too. False: none does.
bool BringBack(const fs::path& database_path, const fs::path& folder, SparseModel* model) {
  const std::vector<std::string> moved = ReposePictures(OpenedToRead(database_path), model);
  if (moved.empty()) return false;
  for (const std::string& name : moved) LogInfo(name + " stood wrong and is posed again");
  *model = WrittenAndRead(folder, std::move(*model));
  return true;
}

// The points anew, in the folder too; and once more where they show that pictures stand wrong.
Triangulation TriangulateAnew(const ColmapProgram& colmap, const AdjustmentJob& job,
                              const fs::path& folder, SparseModel* model) {
  const TriangulationJob triangulation_job = {job.database_path, job.image_path, job.options,
                                              job.log_path, job.must_succeed};
  for (int pass = 1;; ++pass) {
    Triangulation triangulation = Retriangulate(colmap, triangulation_job, folder, *model);
    if (!triangulation.model) return triangulation;
    *model = WrittenAndRead(folder, *std::move(triangulation.model));
    if (pass == 2 || !BringBack(job.database_path, folder, model)) return triangulation;
  }
}

// Of the lens and of the ground's bend.
std::string WhatIsKnown(const LensChoice& choice, const BundleAdjustment& adjustment) {
  const auto frame = FindGroundFrame(adjustment.model);
  return "; " + choice.said +
         (frame ? "; " + Say(DoubtOf(adjustment, *frame, choice.bend)) : std::string());
}

std::string Refusal(const char* what, const std::string& fault) {
  return fault.empty() ? "" : std::string("; ") + what + " kept as the mapper left it: " + fault;
}

// Measures the observations again, and those that matching missed, chooses the form of the lens
// that they prove, unless it is held, and adjusts once more. Returns what is known of the lens, or
// why the model stayed as it was.
std::string MeasureAndAdjust(const AdjustmentJob& job, LensLimits limits, const fs::path& folder,
                             SparseModel* model) {
  const std::map<uint32_t, size_t> num_points2D = NumPoints2D(*model);
  ExtendAndMeasure({job.image_path, job.mask_path, job.num_threads}, num_points2D, model);
  limits.max_focal_ratio = kMaxFocalRatioOnceMore;
  limits.rejects_outliers = true;
  LensChoice choice;
  if (!job.holds_lens) {
    choice = ChooseLens({limits.form.principal_point, job.prior_focals, job.num_threads}, *model);
    limits.form = choice.form;
    *model = InForm(choice.form, std::move(*model));
  }
  SoundAdjustment last = AdjustSoundly(*model, limits);
  if (!last.fault.empty()) {
    *model = ReadSparseModel(folder);
    return Refusal("second adjustment", last.fault);
  }
  const std::string known = job.holds_lens ? "" : WhatIsKnown(choice, last.adjustment);
  DropExtensions(num_points2D, &last.adjustment.model);
  *model = WrittenAndRead(folder, std::move(last.adjustment.model));
  return known;
}

size_t NumContradicted(const AdjustmentJob& job, const SparseModel& model) {
  return MisplacedPictures(CheckMatches(OpenedToRead(job.database_path), model),
                           model.images.size())
      .size();
}

}  // namespace

std::map<uint32_t, double> PriorFocals(const fs::path& database_path) {
  std::map<uint32_t, double> focals;
  if (!fs::exists(database_path)) return focals;
  for (const auto& [id, camera] : ReadCameras(OpenedToRead(database_path))) {
    focals[id] = camera.MeanFocal();
  }
  return focals;
}

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
  limits.form = FirstForm(job.frees_principal_point);
  limits.prior_focals = job.prior_focals;
  limits.holds_lens = job.holds_lens;
  limits.num_threads = job.num_threads;
  SoundAdjustment first = AdjustSoundly(result.model, limits);
  const bool is_sound = first.fault.empty();
  result.distortion_is_sound = is_sound || !job.frees_distortion;
  if (is_sound) result.model = WrittenAndRead(folder, std::move(first.adjustment.model));

  const Triangulation triangulation = TriangulateAnew(colmap, job, folder, &result.model);
  if (triangulation.has_failed) {
    result.is_usable = false;
    return result;
  }

  std::string last;
  if (is_sound) last = MeasureAndAdjust(job, limits, folder, &result.model);
  result.num_contradicted = NumContradicted(job, result.model);
  result.outcome = Outcome(lens_before, result.model.cameras.begin()->second) +
                   Refusal("lens", first.fault) + Refusal("triangulation", triangulation.fault) +
                   last;
  return result;
}

}  // namespace colmap_seapoint
