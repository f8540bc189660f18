#include "colmap_seapoint/rendering/camera_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace colmap_seapoint {
namespace {

constexpr double kMaxRayError = 1e-3;  // on the plane z = 1

}  // namespace

CameraPicture::CameraPicture(const Camera& camera, const Rigid3d& cam_from_world, int point_size)
    : camera_(camera),
      cam_from_world_(cam_from_world),
      point_size_(point_size),
      picture_(camera.width, camera.height, 3),
      depth_(camera.width, camera.height, 1, std::numeric_limits<float>::infinity()) {}

void CameraPicture::Add(const Eigen::Vector3d& xyz, const std::array<uint8_t, 3>& rgb) {
  const Eigen::Vector3d in_cam = cam_from_world_ * xyz;
  const std::optional<Eigen::Vector2d> pixel = camera_.ImgFromCam(in_cam);
  if (!pixel || !camera_.InImage(*pixel)) return;
  const std::optional<Eigen::Vector2d> ray = camera_.CamFromImg(*pixel);
  if (!ray || (*ray - in_cam.hnormalized()).norm() > kMaxRayError * (1 + ray->norm())) return;
  const double half = 0.5 * (point_size_ - 1);
  const int left = static_cast<int>(std::floor(pixel->x() - half));
  const int top = static_cast<int>(std::floor(pixel->y() - half));
  const auto depth = static_cast<float>(in_cam.z());
  for (int y = std::max(top, 0); y < std::min(top + point_size_, depth_.height); ++y) {
    for (int x = std::max(left, 0); x < std::min(left + point_size_, depth_.width); ++x) {
      if (depth >= depth_.At(x, y)) continue;
      depth_.At(x, y) = depth;
      for (int c = 0; c < 3; ++c) picture_.At(x, y, c) = rgb[static_cast<size_t>(c)];
    }
  }
}

}  // namespace colmap_seapoint
