// Where two posed pictures can show the same: the rectified frame of a pair (ours: the poses are
// known, so the search is along the epipolar line). Any camera model, any motion between the two.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/rigid3.h"

namespace colmap_seapoint {

// Two rays that meet at less than two degrees say too little of the distance: a tenth of a pixel is
// three ground sampling distances there.
inline constexpr double kMinSineOfParallax = 0.035;

// What the rays of the frame "rect" are laid out on, so that rows are epipolar lines.
enum class RectSurface {
  // The plane z = focal: x / z, y / z. A surface that faces both cameras has one disparity, which
  // no other layout has; but the plane ends where a camera looks along the baseline.
  kPlane,
  // Mercator's map with the baseline as its axis (ours): rows are the half planes around the
  // baseline, evenly by their angle, and x = focal * asinh(cot of the angle to the baseline).
  // Nothing but the baseline itself is left out, so that the epipole may lie far away, near, or in
  // the picture. The map is conformal, and a place is drawn at focal / (its distance from the
  // baseline) from either camera: whatever faces the cameras has the same size in both pictures,
  // however much nearer one of them is. So windows need not follow the change of scale along a row.
  kMercator,
};

// The axes of the frame: x along the baseline from camera 1 to camera 2, z across it towards what
// the two cameras look at. x and y below are rect pixels without offset: (0, 0) lies on the z axis.
// A point has the disparity x1 - x2 > 0, the larger the nearer it is.
struct PairGeometry {
  Camera camera1, camera2;
  Eigen::Matrix3d cam1_from_rect, cam2_from_rect, world_from_rect;
  Eigen::Vector3d center1;  // world
  RectSurface surface = RectSurface::kPlane;
  double focal = 0;     // rect pixels: a radian on the z axis
  double baseline = 0;  // model units

  // The direction in the rect frame (of camera 1 or of camera 2) that is drawn at (x, y): of length
  // 1 across the baseline on Mercator's map, along z on the plane.
  Eigen::Vector3d RayAt(double x, double y) const;
  // Where a direction in the rect frame is drawn; nullopt for what the surface does not hold.
  std::optional<Eigen::Vector2d> RectFromRay(const Eigen::Vector3d& ray) const;
  std::optional<Eigen::Vector2d> RectFromPixel1(const Eigen::Vector2d& pixel) const;
  std::optional<Eigen::Vector2d> RectFromPixel2(const Eigen::Vector2d& pixel) const;

  // The point that camera 1 draws at (x, y) with disparity d > 0: from its centre, rect frame.
  Eigen::Vector3d PointInRect(double x, double y, double disparity) const;
  Eigen::Vector3d PointInWorld(double x, double y, double disparity) const {
    return world_from_rect * PointInRect(x, y, disparity) + center1;
  }
  // Normal of the surface whose disparity there is d and changes by slope_x, slope_y a pixel: unit,
  // rect frame, towards camera 1.
  Eigen::Vector3d NormalInRect(double x, double y, double disparity, double slope_x,
                               double slope_y) const;
  // Disparity of a point at (x, y) at a distance from the centre of camera 1, model units.
  double DisparityAtRange(double x, double y, double range) const;
  // Sine of the angle at which the two rays meet there.
  double SineOfParallax(double x, double y, double disparity) const;
  // By what share of itself a point's range changes with a pixel of its disparity.
  double RangePerDisparity(double x, double disparity) const;
  // How many rect pixels a pixel of camera 1 is drawn across, about: grows towards the epipole.
  double Magnification(double x) const;
  // Where the map magnifies, only one of so many samples of a row, and of the rows, becomes a
  // point, so that a cloud is nowhere denser than picture 1: 1 or more.
  double SampleSpacing(double x) const { return std::max(1.0, Magnification(x)); }
};

// nullopt when the cameras coincide. The plane where both pictures fit on it without much stretch,
// else Mercator's map.
std::optional<PairGeometry> MakePairGeometry(const Camera& camera1, const Rigid3d& cam1_from_world,
                                             const Camera& camera2, const Rigid3d& cam2_from_world);

}  // namespace colmap_seapoint
