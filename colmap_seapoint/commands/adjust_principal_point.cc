#include "colmap_seapoint/commands/adjust_principal_point.h"

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

constexpr double kMaxFocalChange = 0.2;  // share of the focal length
constexpr size_t kMinPictures = 3;
// A few observations come in anew.
constexpr double kMaxErrorGrowth = 1.02;
constexpr double kMaxPrincipalPointChange = 0.05;  // share of the longer side

// Root mean square over all observations of triangulated points, pixels.
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

// "" when the lens has changed by no more than a calibration may.
std::string LensFault(const Camera& before, const Camera& after) {
  const double focal_change = std::max(std::abs(after.FocalX() / before.FocalX() - 1),
                                       std::abs(after.FocalY() / before.FocalY() - 1));
  if (!(focal_change <= kMaxFocalChange)) return "the focal length moved too far";
  const double point_change = std::hypot(after.PrincipalX() - before.PrincipalX(),
                                         after.PrincipalY() - before.PrincipalY());
  if (!(point_change <= kMaxPrincipalPointChange * std::max(before.width, before.height))) {
    return "the principal point moved too far";
  }
  return "";
}

std::string Fault(const SparseModel& before, const SparseModel& after) {
  if (after.images.size() != before.images.size() ||
      after.cameras.size() != before.cameras.size()) {
    return "pictures were lost";
  }
  for (const auto& [id, camera] : before.cameras) {
    const auto found = after.cameras.find(id);
    if (found == after.cameras.end()) return "a camera was lost";
    const std::string fault = LensFault(camera, found->second);
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

std::vector<std::string> Arguments(const AdjustmentJob& job, const SparseModel& model,
                                   const fs::path& input, const fs::path& output) {
  // Else the mapper would go on to pictures that are not the model's.
  std::string names;
  for (const PosedImage& image : model.images) names += image.name + "\n";
  const fs::path list = input / "pictures.txt";
  WriteTextFile(list, names);
  MapperOptions options = job.options;
  options["Mapper.ba_refine_principal_point"] = "1";
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

}  // namespace

std::string AdjustPrincipalPoint(const ColmapProgram& colmap, const AdjustmentJob& job,
                                 const fs::path& model) {
  const SparseModel before = ReadSparseModel(model);
  if (before.images.size() < kMinPictures) return "left as the mapper found it: too few pictures";
  const fs::path reduced = model.string() + ".reduced", adjusted = model.string() + ".adjusted";
  std::error_code error;
  for (const fs::path& folder : {reduced, adjusted}) {
    fs::remove_all(folder, error);
    fs::create_directories(folder);
  }
  WriteSparseModelBinary(reduced, WithoutPicture(before, MostSeeing(before)));
  const auto result = RunSubprocess(colmap.path, Arguments(job, before, reduced, adjusted),
                                    job.log_path, [](const std::string&) {});
  std::string outcome;
  if (!result.Succeeded() || !IsSparseModel(adjusted)) {
    outcome = "left as the mapper found it: the adjustment failed (" + result.Text() + ")";
  } else {
    const SparseModel after = ReadSparseModel(adjusted);
    const std::string fault = Fault(before, after);
    if (fault.empty()) {
      WriteSparseModelBinary(model, after);
      outcome = Outcome(before, after);
    } else {
      outcome = "left as the mapper found it: " + fault;
    }
  }
  for (const fs::path& folder : {reduced, adjusted}) fs::remove_all(folder, error);
  return outcome;
}

}  // namespace colmap_seapoint
