#include "examples/survey/paths/survey_camera.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr double kMaxFisheyeAngle = 86 * 3.14159265358979323846 / 180;

}  // namespace

Camera MakeSurveyCamera(const SurveyOptions& options) {
  Camera camera =
      MakeCamera(options.camera_model, NominalFocal(options), options.width, options.height);
  camera.camera_id = 1;
  camera.params[1] *= 1.0015;
  camera.params[2] += 0.0046 * options.width;
  camera.params[3] -= 0.0040 * options.height;
  if (options.camera_model == CameraModel::kOpenCVFisheye) {
    camera.params[4] = 0.012;
    camera.params[5] = -0.006;
    camera.params[6] = 0.0012;
    camera.params[7] = -2e-4;
    return camera;
  }
  camera.params[4] = -0.11;
  camera.params[5] = 0.045;
  camera.params[6] = 4e-4;
  camera.params[7] = -3e-4;
  return camera;
}

double MaxTangent(const Camera& camera) {
  const double limit = std::tan(kMaxFisheyeAngle);
  double max = 0;
  for (double x : {0.0, 0.5, 1.0}) {
    for (double y : {0.0, 0.5, 1.0}) {
      const auto ray = camera.CamFromImg({x * camera.width, y * camera.height});
      max = std::max(max, ray ? ray->norm() : limit);
    }
  }
  return std::min(1.02 * max, limit);
}

double GsdAt(const Camera& camera, const Eigen::Vector3d& point_in_cam) {
  const bool is_fisheye = camera.model == CameraModel::kOpenCVFisheye;
  return (is_fisheye ? point_in_cam.norm() : point_in_cam.z()) / camera.MeanFocal();
}

}  // namespace colmap_seapoint
