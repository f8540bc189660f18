#include "colmap_seapoint/orthomosaic/ground/patch_projection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace colmap_seapoint {
namespace {

constexpr double kProbe = 24;       // pixels from the middle, where the lens is asked
constexpr double kMaxError = 0.05;  // pixels
constexpr double kMaxReach = 2;     // probes

}  // namespace

PatchProjection::PatchProjection(const MapView& view, const MapGrid& grid,
                                 const Eigen::Vector3d& middle)
    : view_(view), middle_(middle) {
  const Eigen::Vector2d place = grid.PlaceOf(middle.x(), middle.y());
  in_cam_ = view.InCam({place.x(), place.y(), middle.z()});
  const Eigen::Vector3d map_units(grid.pixel_size, -grid.pixel_size, 1);  // a column, a row, height
  in_cam_from_pixels_ = view.Rotation() * map_units.asDiagonal();
  MakeLinear();
}

void PatchProjection::PixelsOfRow(double column, double row, const float* heights, int count,
                                  float* x, float* y) const {
  const Eigen::Vector3f first =
      (in_cam_ + in_cam_from_pixels_ * (Eigen::Vector3d(column, row, middle_.z()) - middle_))
          .cast<float>();
  const Eigen::Vector3f step = in_cam_from_pixels_.col(0).cast<float>();
  const Eigen::Vector3f up = in_cam_from_pixels_.col(2).cast<float>();
  const Eigen::Matrix2f lens = pixel_from_ray_.cast<float>();
  const auto middle_height = static_cast<float>(middle_.z());
  const auto reach = static_cast<float>(reach_);
  const auto ray_x = static_cast<float>(ray_.x()), ray_y = static_cast<float>(ray_.y());
  const auto pixel_x = static_cast<float>(pixel_.x()), pixel_y = static_cast<float>(pixel_.y());
  int num_linear = 0;
  for (int i = 0; i < count; ++i) {
    const auto steps = static_cast<float>(i);
    const float height = heights[i] - middle_height;
    const float z = first.z() + steps * step.z() + height * up.z();
    const float u = (first.x() + steps * step.x() + height * up.x()) / z - ray_x;
    const float v = (first.y() + steps * step.y() + height * up.y()) / z - ray_y;
    num_linear += z > 0 && std::abs(u) <= reach && std::abs(v) <= reach;
    x[i] = pixel_x + lens(0, 0) * u + lens(0, 1) * v;
    y[i] = pixel_y + lens(1, 0) * u + lens(1, 1) * v;
  }
  const Camera& camera = view_.GetCamera();
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < count; ++i) {
    std::optional<Eigen::Vector2d> pixel = Eigen::Vector2d(double{x[i]}, double{y[i]});
    if (num_linear < count) pixel = PixelOf({column + i, row, double{heights[i]}});
    const bool is_shown = pixel && camera.InImage(*pixel);
    x[i] = is_shown ? static_cast<float>(pixel->x()) : kNone;
    y[i] = is_shown ? static_cast<float>(pixel->y()) : kNone;
  }
}

// The lens's second differences tell how far its tangent is right.
void PatchProjection::MakeLinear() {
  const auto pixel = view_.PixelOfInCam(in_cam_);
  if (!pixel) return;
  ray_ = in_cam_.head<2>() / in_cam_.z();
  pixel_ = *pixel;
  const double probe = kProbe / view_.GetCamera().MeanFocal();
  const auto at = [&](double x, double y) {
    return view_.GetCamera().ImgFromCam((ray_ + probe * Eigen::Vector2d(x, y)).homogeneous());
  };
  const auto left = at(-1, 0), right = at(1, 0), above = at(0, -1), below = at(0, 1),
             corner = at(1, 1), opposite = at(1, -1);
  if (!left || !right || !above || !below || !corner || !opposite) return;
  pixel_from_ray_.col(0) = (*right - *left) / (2 * probe);
  pixel_from_ray_.col(1) = (*below - *above) / (2 * probe);
  double error = 0;
  for (const auto& [found, x, y] :
       {std::make_tuple(*left, -1, 0), std::make_tuple(*right, 1, 0),
        std::make_tuple(*above, 0, -1), std::make_tuple(*below, 0, 1),
        std::make_tuple(*corner, 1, 1), std::make_tuple(*opposite, 1, -1)}) {
    const Eigen::Vector2d linear = pixel_ + pixel_from_ray_ * (probe * Eigen::Vector2d(x, y));
    error = std::max(error, (found - linear).norm());
  }
  reach_ = probe * std::min(std::sqrt(kMaxError / std::max(error, 1e-9)), kMaxReach);
}

}  // namespace colmap_seapoint
