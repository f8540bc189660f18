#include "colmap_seapoint/lens/refraction_sign.h"

#include <cmath>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinPictures = 3;
constexpr double kMaxErrors = 4;  // of the median; what is beyond is a wrong match

struct RadialError {
  size_t picture;
  double radius, depth, error, size;  // tangent; model's unit; pixels: outwards, in all
};

std::vector<RadialError> ErrorsOf(const SparseModel& model) {
  std::vector<RadialError> errors;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const PosedImage& image = model.images[i];
    const auto camera = model.cameras.find(image.camera_id);
    if (camera == model.cameras.end()) continue;
    const Eigen::Vector2d middle(camera->second.PrincipalX(), camera->second.PrincipalY());
    for (size_t k = 0; k < image.points2D.size(); ++k) {
      const auto point = model.points3D.find(image.point3D_ids[k]);
      if (point == model.points3D.end() || point->second.track.size() < 3) continue;
      const Eigen::Vector3d in_cam = image.cam_from_world * point->second.xyz;
      const auto pixel = camera->second.ImgFromCam(in_cam);
      if (!pixel || (*pixel - middle).isZero()) continue;
      const Eigen::Vector2d error = image.points2D[k] - *pixel;
      errors.push_back({i, in_cam.hnormalized().norm(), in_cam.z(),
                        error.dot((*pixel - middle).normalized()), error.norm()});
    }
  }
  return errors;
}

}  // namespace

double RefractionSign(const SparseModel& model) {
  const std::vector<RadialError> errors = ErrorsOf(model);
  if (model.images.size() < kMinPictures || errors.empty()) return 0;
  std::vector<double> depths, sizes;
  for (const RadialError& e : errors) {
    depths.push_back(e.depth);
    sizes.push_back(e.size);
  }
  const double distance = UpperMedian(std::move(depths));
  const double limit = kMaxErrors * UpperMedian(std::move(sizes));
  std::vector<double> sums(model.images.size());
  for (const RadialError& e : errors) {
    if (!(e.size <= limit)) continue;
    sums[e.picture] += std::pow(e.radius, 3) * (distance / e.depth - 1) * e.error;
  }
  double sum = 0, squares = 0;
  for (const double of_picture : sums) {
    sum += of_picture;
    squares += of_picture * of_picture;
  }
  return squares > 0 ? sum / std::sqrt(squares) : 0;
}

}  // namespace colmap_seapoint
