#include "colmap_seapoint/commands/adjust_principal_point.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/io/colmap_model.h"
#include "colmap_seapoint/io/subprocess.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxFocalChange = 0.2;            // share of the focal length
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
  if (ReprojectionError(after) > ReprojectionError(before)) return "the error grew";
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

}  // namespace

std::string AdjustPrincipalPoint(const ColmapProgram& colmap, const fs::path& model,
                                 const fs::path& log_path) {
  const fs::path adjusted = model.string() + ".adjusted";
  std::error_code error;
  fs::remove_all(adjusted, error);
  fs::create_directories(adjusted);
  const auto result =
      RunSubprocess(colmap.path,
                    {"bundle_adjuster", "--input_path", model.string(), "--output_path",
                     adjusted.string(), "--BundleAdjustment.refine_principal_point", "1"},
                    log_path, [](const std::string&) {});
  std::string outcome;
  if (!result.Succeeded() || !IsSparseModel(adjusted)) {
    outcome = "left as the mapper found it: the bundle adjuster failed (" + result.Text() + ")";
  } else {
    const SparseModel before = ReadSparseModel(model), after = ReadSparseModel(adjusted);
    const std::string fault = Fault(before, after);
    if (fault.empty()) {
      WriteSparseModelBinary(model, after);
      outcome = Outcome(before, after);
    } else {
      outcome = "left as the mapper found it: " + fault;
    }
  }
  fs::remove_all(adjusted, error);
  return outcome;
}

}  // namespace colmap_seapoint
