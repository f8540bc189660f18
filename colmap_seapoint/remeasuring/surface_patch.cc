#include "colmap_seapoint/remeasuring/surface_patch.h"

namespace colmap_seapoint {
namespace {

// Half of the span over which the warp is taken to be affine: that of most of a patch.
constexpr double kSpan = 5;  // pixels
// The mean square of the distance from a patch's middle row, over that of the span.
constexpr double kMeanSquare = warp::kReach * (warp::kReach + 1) / (3.0 * kSpan * kSpan);

Eigen::Vector3d BendOf(const Eigen::Vector3d& before, const Eigen::Vector3d& middle,
                       const Eigen::Vector3d& behind) {
  return 0.5 * (before + behind) - middle;
}

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
                      (to_world * (*below - *above) / (2 * kSpan)).cast<float>(),
                      (to_world * BendOf(*left, *middle, *right)).cast<float>(),
                      (to_world * BendOf(*above, *middle, *below)).cast<float>()};
}

std::optional<PredictedPatch> PredictPatch(const Camera& camera, const Rigid3d& cam_from_world,
                                           const SurfacePatch& patch) {
  const Eigen::Vector3d middle = cam_from_world * patch.middle;
  const auto turned = [&](const Eigen::Vector3f& v) -> Eigen::Vector3d {
    return cam_from_world.rotation * v.cast<double>();
  };
  const Eigen::Vector3d across = kSpan * turned(patch.across), down = kSpan * turned(patch.down);
  const Eigen::Vector3d row = middle + turned(patch.bend_across);
  const Eigen::Vector3d column = middle + turned(patch.bend_down);
  const auto pixel = camera.ImgFromCam(middle);
  const auto left = camera.ImgFromCam(row - across);
  const auto right = camera.ImgFromCam(row + across);
  const auto above = camera.ImgFromCam(column - down);
  const auto below = camera.ImgFromCam(column + down);
  if (!pixel || !left || !right || !above || !below) return std::nullopt;
  PredictedPatch predicted;
  predicted.bend = kMeanSquare * (0.5 * (*left + *right + *above + *below) - 2 * *pixel);
  predicted.place.pixel = *pixel + predicted.bend;
  predicted.place.other_from_reference.col(0) = (*right - *left) / (2 * kSpan);
  predicted.place.other_from_reference.col(1) = (*below - *above) / (2 * kSpan);
  return predicted;
}

}  // namespace colmap_seapoint
