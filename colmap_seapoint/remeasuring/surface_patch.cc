#include "colmap_seapoint/remeasuring/surface_patch.h"

namespace colmap_seapoint {
namespace {

// Half of the span over which the warp is taken to be affine: that of most of a patch.
constexpr double kSpan = 5;  // pixels

}  // namespace

std::optional<SurfacePatch> PatchOnPlane(const Camera& camera, const Rigid3d& cam_from_world,
                                         const SeenPlane& plane, const Eigen::Vector2d& pixel) {
  const auto on_plane = [&](double dx, double dy) -> std::optional<Eigen::Vector3d> {
    const auto direction = camera.CamFromImg(pixel + Eigen::Vector2d(dx, dy));
    return direction ? plane.At(*direction) : std::nullopt;
  };
  const auto middle = on_plane(0, 0);
  const auto left = on_plane(-kSpan, 0), right = on_plane(kSpan, 0);
  const auto above = on_plane(0, -kSpan), below = on_plane(0, kSpan);
  if (!middle || !left || !right || !above || !below) return std::nullopt;
  const Eigen::Quaterniond to_world = cam_from_world.rotation.conjugate();
  return SurfacePatch{cam_from_world.Inverse() * *middle,
                      (to_world * (*right - *left) / (2 * kSpan)).cast<float>(),
                      (to_world * (*below - *above) / (2 * kSpan)).cast<float>()};
}

std::optional<PredictedPlace> PredictPlace(const Camera& camera, const Rigid3d& cam_from_world,
                                           const SurfacePatch& patch) {
  const Eigen::Vector3d middle = cam_from_world * patch.middle;
  const Eigen::Vector3d across = cam_from_world.rotation * (kSpan * patch.across.cast<double>());
  const Eigen::Vector3d down = cam_from_world.rotation * (kSpan * patch.down.cast<double>());
  const auto pixel = camera.ImgFromCam(middle);
  const auto left = camera.ImgFromCam(middle - across);
  const auto right = camera.ImgFromCam(middle + across);
  const auto above = camera.ImgFromCam(middle - down);
  const auto below = camera.ImgFromCam(middle + down);
  if (!pixel || !left || !right || !above || !below) return std::nullopt;
  PredictedPlace place;
  place.pixel = *pixel;
  place.other_from_reference.col(0) = (*right - *left) / (2 * kSpan);
  place.other_from_reference.col(1) = (*below - *above) / (2 * kSpan);
  return place;
}

}  // namespace colmap_seapoint
