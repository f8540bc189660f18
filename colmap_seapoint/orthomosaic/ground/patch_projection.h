// Where a picture shows the pixels of a small part of a map, without its lens's formulas at each of
// them.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "colmap_seapoint/orthomosaic/ground/map_grid.h"
#include "colmap_seapoint/orthomosaic/ground/map_view.h"

namespace colmap_seapoint {

// Perspective is exact. The lens is linear about one place, as far as that is right within a
// twentieth of a pixel, and exact beyond. `view` outlives it.
class PatchProjection {
 public:
  // `middle`: column and row of the map, and height.
  PatchProjection(const MapView& view, const MapGrid& grid, const Eigen::Vector3d& middle);

  // MapView::PixelOf() of such a place. About 5 ns.
  std::optional<Eigen::Vector2d> PixelOf(const Eigen::Vector3d& place) const {
    const Eigen::Vector3d in_cam = in_cam_ + in_cam_from_pixels_ * (place - middle_);
    if (!(in_cam.z() > 0)) return std::nullopt;
    const Eigen::Vector2d step = in_cam.head<2>() / in_cam.z() - ray_;
    if (!(step.cwiseAbs().maxCoeff() <= reach_)) return view_.PixelOfInCam(in_cam);
    const Eigen::Vector2d pixel = pixel_ + pixel_from_ray_ * step;
    if (!view_.GetCamera().InImage(pixel)) return std::nullopt;
    return pixel;
  }

  // The same for the `count` places of a row, one column apart from `column` on, at these heights:
  // NaN where the picture does not show one. In single precision, right within a thousandth of a
  // pixel. About 2 ns a place.
  void PixelsOfRow(double column, double row, const float* heights, int count, float* x,
                   float* y) const;

 private:
  void MakeLinear();

  const MapView& view_;
  Eigen::Vector3d middle_, in_cam_;
  Eigen::Matrix3d in_cam_from_pixels_;
  // At the middle: x and y on the plane z = 1, the pixel, and the lens about it.
  Eigen::Vector2d ray_ = Eigen::Vector2d::Zero(), pixel_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d pixel_from_ray_ = Eigen::Matrix2d::Zero();
  double reach_ = -1;  // of the linear lens, from ray_ along x and y
};

}  // namespace colmap_seapoint
