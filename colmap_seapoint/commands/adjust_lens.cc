#include "colmap_seapoint/commands/adjust_lens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <system_error>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/atomic_file.h"
#include "colmap_seapoint/io/colmap_model.h"
#include "colmap_seapoint/io/subprocess.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMinPictures = 3;
constexpr double kMaxErrorGrowth = 1.02;           // a few observations come in anew
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

std::string Fault(const SparseModel& before, const SparseModel& after, double max_focal_ratio) {
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
  if (ReprojectionError(after) > kMaxErrorGrowth * ReprojectionError(before)) {
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

size_t NumPointsSeen(const PosedImage& image) {
  return image.point3D_ids.size() -
         static_cast<size_t>(
             std::count(image.point3D_ids.begin(), image.point3D_ids.end(), kNoPoint3D));
}

// The picture that the mapper will find again most surely.
uint32_t MostSeeing(const SparseModel& model) {
  const auto most = std::max_element(
      model.images.begin(), model.images.end(),
      [](const auto& a, const auto& b) { return NumPointsSeen(a) < NumPointsSeen(b); });
  return most->image_id;
}

SparseModel WithoutPicture(SparseModel model, uint32_t image_id) {
  std::set<uint64_t> lost;  // points that one picture alone would see
  for (auto& [id, point] : model.points3D) {
    auto& track = point.track;
    const auto is_gone = [&](const auto& element) { return element.image_id == image_id; };
    track.erase(std::remove_if(track.begin(), track.end(), is_gone), track.end());
    if (track.size() < 2) lost.insert(id);
  }
  for (uint64_t id : lost) model.points3D.erase(id);
  const auto is_gone = [&](const PosedImage& image) { return image.image_id == image_id; };
  model.images.erase(std::remove_if(model.images.begin(), model.images.end(), is_gone),
                     model.images.end());
  for (PosedImage& image : model.images) {
    for (uint64_t& id : image.point3D_ids) {
      if (lost.count(id) > 0) id = kNoPoint3D;
    }
  }
  return model;
}

std::vector<std::string> Arguments(const AdjustmentJob& job, const Adjustment& adjustment,
                                   const SparseModel& model, const fs::path& input,
                                   const fs::path& output) {
  // Else the mapper would go on to pictures that are not the model's.
  std::string names;
  for (const PosedImage& image : model.images) names += image.name + "\n";
  const fs::path list = input / "pictures.txt";
  WriteTextFile(list, names);
  MapperOptions options = job.options;
  options["Mapper.ba_refine_extra_params"] = "1";
  options["Mapper.ba_refine_principal_point"] = adjustment.frees_principal_point ? "1" : "0";
  options["Mapper.ba_global_max_num_iterations"] = "300";  // 50 in COLMAP: it stops on the way
  std::vector<std::string> arguments = {
      "mapper",        "--database_path",       job.database_path.string(),
      "--image_path",  job.image_path.string(), "--image_list_path",
      list.string(),   "--input_path",          input.string(),
      "--output_path", output.string()};
  for (const auto& [name, value] : options) {
    arguments.insert(arguments.end(), {"--" + name, value});
  }
  return arguments;
}

// "" when the adjusted model has taken the model's place; else why not.
std::string Adjust(const ColmapProgram& colmap, const AdjustmentJob& job,
                   const Adjustment& adjustment, const fs::path& model) {
  const SparseModel before = ReadSparseModel(model);
  if (before.images.size() < kMinPictures) return "too few pictures";
  const fs::path reduced = model.string() + ".reduced", adjusted = model.string() + ".adjusted";
  std::error_code error;
  for (const fs::path& folder : {reduced, adjusted}) {
    fs::remove_all(folder, error);
    fs::create_directories(folder);
  }
  WriteSparseModelBinary(reduced, WithoutPicture(before, MostSeeing(before)));
  const auto result = RunSubprocess(
      colmap.path, Arguments(job, adjustment, before, reduced, adjusted),
      job.log_path.string() + "_" + adjustment.name + ".log", [](const std::string&) {});
  std::string fault;
  if (!result.Succeeded() || !IsSparseModel(adjusted)) {
    fault = "the mapper failed (" + result.Text() + ")";
  } else {
    const SparseModel after = ReadSparseModel(adjusted);
    fault = Fault(before, after, adjustment.max_focal_ratio);
    if (fault.empty()) WriteSparseModelBinary(model, after);
  }
  for (const fs::path& folder : {reduced, adjusted}) fs::remove_all(folder, error);
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
  // It frees the distortion too.
  if (job.frees_principal_point && result.distortion_is_sound) adjust(kPrincipalPoint);
  result.outcome = Outcome(before, ReadSparseModel(model)) + refused;
  return result;
}

}  // namespace colmap_seapoint
