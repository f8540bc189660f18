#include "densify/match/pair_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace colmap_seapoint {

namespace {

constexpr double kMaxPlaneSlope = 1.3;  // |x / z| and |y / z| of the rays of a picture on the plane
constexpr double kMinAcross = 0.05;     // of the viewing directions, below it they are the baseline
constexpr int kSamples = 16;            // pixels looked at across and down a picture
constexpr double kSharpShare = 0.8;     // of picture 1 that keeps its resolution on Mercator's map

// Directions of pixels all over a picture, rect frame.
std::vector<Eigen::Vector3d> RaysOf(const Camera& camera, const Eigen::Matrix3d& cam_from_rect) {
  std::vector<Eigen::Vector3d> rays;
  for (int j = 0; j <= kSamples; ++j) {
    for (int i = 0; i <= kSamples; ++i) {
      const auto ray = camera.CamFromImg({static_cast<double>(camera.width) * i / kSamples,
                                          static_cast<double>(camera.height) * j / kSamples});
      if (ray) rays.push_back(cam_from_rect.transpose() * ray->homogeneous().normalized());
    }
  }
  return rays;
}

bool FitOnPlane(const std::vector<Eigen::Vector3d>& rays) {
  return std::all_of(rays.begin(), rays.end(), [](const Eigen::Vector3d& ray) {
    return std::max(std::abs(ray.x()), std::abs(ray.y())) < kMaxPlaneSlope * ray.z();
  });
}

// Mercator's map magnifies towards the epipoles. Picture 1 keeps its resolution, or more, but for
// the part farthest from them.
double MercatorFocal(const Camera& camera1, const std::vector<Eigen::Vector3d>& rays1) {
  std::vector<double> sines;
  for (const Eigen::Vector3d& ray : rays1) sines.push_back(std::hypot(ray.y(), ray.z()));
  if (sines.empty()) return camera1.MeanFocal();
  const auto at = sines.begin() +
                  static_cast<std::ptrdiff_t>(kSharpShare * static_cast<double>(sines.size() - 1));
  std::nth_element(sines.begin(), at, sines.end());
  return camera1.MeanFocal() * *at;
}

// Unit, across the baseline, towards what the cameras look at. Where they look along the baseline,
// the frame is cut open opposite to camera 1's downward axis: above a swimmer is open water.
Eigen::Vector3d AxisAcross(const Eigen::Vector3d& baseline, const Rigid3d& cam1_from_world,
                           const Rigid3d& cam2_from_world) {
  const auto across = [&](const Eigen::Vector3d& direction) {
    return Eigen::Vector3d(direction - baseline.dot(direction) * baseline);
  };
  const Eigen::Quaterniond world_from_cam1 = cam1_from_world.rotation.conjugate();
  const Eigen::Vector3d views = world_from_cam1 * Eigen::Vector3d::UnitZ() +
                                cam2_from_world.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  for (const Eigen::Vector3d& direction :
       {views, Eigen::Vector3d(world_from_cam1 * Eigen::Vector3d::UnitY())}) {
    if (across(direction).norm() > kMinAcross) return across(direction).normalized();
  }
  return across(world_from_cam1 * Eigen::Vector3d::UnitX()).normalized();
}

}  // namespace

Eigen::Vector3d PairGeometry::RayAt(double x, double y) const {
  const double u = x / focal, v = y / focal;
  if (surface == RectSurface::kPlane) return {u, v, 1};
  return {std::sinh(u), std::sin(v), std::cos(v)};
}

std::optional<Eigen::Vector2d> PairGeometry::RectFromRay(const Eigen::Vector3d& ray) const {
  if (surface == RectSurface::kPlane) {
    if (!(ray.z() > 1e-3 * ray.norm())) return std::nullopt;
    return Eigen::Vector2d(focal * ray.hnormalized());
  }
  const double across = std::hypot(ray.y(), ray.z());
  if (!(across > 1e-6 * ray.norm())) return std::nullopt;
  return Eigen::Vector2d(focal * std::asinh(ray.x() / across),
                         focal * std::atan2(ray.y(), ray.z()));
}

std::optional<Eigen::Vector2d> PairGeometry::RectFromPixel1(const Eigen::Vector2d& pixel) const {
  const auto ray = camera1.CamFromImg(pixel);
  if (!ray) return std::nullopt;
  return RectFromRay(cam1_from_rect.transpose() * ray->homogeneous());
}

std::optional<Eigen::Vector2d> PairGeometry::RectFromPixel2(const Eigen::Vector2d& pixel) const {
  const auto ray = camera2.CamFromImg(pixel);
  if (!ray) return std::nullopt;
  return RectFromRay(cam2_from_rect.transpose() * ray->homogeneous());
}

// On the plane depth = focal * baseline / d. On Mercator's map, r being the distance from the
// baseline, camera 1 sees the point r sinh(x1 / focal) ahead along it and camera 2 r sinh(x2 /
// focal): the difference is the baseline. It is written as a product so that nothing cancels.
Eigen::Vector3d PairGeometry::PointInRect(double x, double y, double disparity) const {
  if (surface == RectSurface::kPlane) {
    return baseline / disparity * Eigen::Vector3d(x, y, focal);
  }
  const double u = x / focal, half = 0.5 * disparity / focal;
  return baseline / (2 * std::cosh(u - half) * std::sinh(half)) * RayAt(x, y);
}

// On the plane d = c + p x + q y gives the plane n . X = const with n ~ (p, q, (d - p x - q y) /
// focal), since d X = baseline (x, y, focal). On Mercator's map the two tangents are crossed.
Eigen::Vector3d PairGeometry::NormalInRect(double x, double y, double disparity, double slope_x,
                                           double slope_y) const {
  const Eigen::Vector3d ray = RayAt(x, y);
  Eigen::Vector3d normal;
  if (surface == RectSurface::kPlane) {
    normal = {slope_x, slope_y, (disparity - slope_x * x - slope_y * y) / focal};
  } else {
    const double u1 = x / focal, u2 = u1 - disparity / focal, v = y / focal;
    const double inverse = std::sinh(u1) - std::sinh(u2);  // baseline / r
    // Relative change of r along x and along y, times focal.
    const double along_x = -(std::cosh(u1) - std::cosh(u2) * (1 - slope_x)) / inverse;
    const double along_y = -std::cosh(u2) * slope_y / inverse;
    const Eigen::Vector3d tangent_x = along_x * ray + Eigen::Vector3d(std::cosh(u1), 0, 0);
    const Eigen::Vector3d tangent_y = along_y * ray + Eigen::Vector3d(0, std::cos(v), -std::sin(v));
    normal = tangent_x.cross(tangent_y);
  }
  return normal.dot(ray) > 0 ? Eigen::Vector3d(-normal.normalized()) : normal.normalized();
}

double PairGeometry::DisparityAtRange(double x, double y, double range) const {
  const double along_ray = range / RayAt(x, y).norm();  // depth; on Mercator's map r
  if (surface == RectSurface::kPlane) return focal * baseline / along_ray;
  const double u = x / focal;
  return focal * (u - std::asinh(std::sinh(u) - baseline / along_ray));
}

// The sine rule in the triangle of the two centres and the point. On Mercator's map the same
// follows from how fast the range changes: by range / sin(parallax) a radian of ray 2, which is
// drawn as large as one of ray 1, focal * cosh(u) pixels.
double PairGeometry::SineOfParallax(double x, double y, double disparity) const {
  if (surface == RectSurface::kMercator) {
    return 1 / (focal * std::cosh(x / focal) * RangePerDisparity(x, disparity));
  }
  const Eigen::Vector3d point = PointInRect(x, y, disparity);
  const double across_squared = point.y() * point.y() + point.z() * point.z();
  const double along = point.x() - baseline;  // from camera 2
  return baseline *
         std::sqrt(across_squared / (point.squaredNorm() * (along * along + across_squared)));
}

// The derivative of the logarithm of the factor in PointInRect. On Mercator's map that is
// cosh(u - 2 half) / (2 focal cosh(u - half) sinh(half)), half = disparity / (2 focal).
double PairGeometry::RangePerDisparity(double x, double disparity) const {
  if (surface == RectSurface::kPlane) return 1 / disparity;
  const double grown = std::exp(0.5 * disparity / focal);  // e^half
  const double at = std::exp(x / focal) / grown;           // e^(u - half)
  return (at / grown + grown / at) / (focal * (at + 1 / at) * (grown - 1 / grown));
}

double PairGeometry::Magnification(double x) const {
  return surface == RectSurface::kPlane ? 1 : focal * std::cosh(x / focal) / camera1.MeanFocal();
}

std::optional<PairGeometry> MakePairGeometry(const Camera& camera1, const Rigid3d& cam1_from_world,
                                             const Camera& camera2,
                                             const Rigid3d& cam2_from_world) {
  PairGeometry geometry;
  geometry.center1 = cam1_from_world.OriginInSource();
  const Eigen::Vector3d along = cam2_from_world.OriginInSource() - geometry.center1;
  geometry.baseline = along.norm();
  if (!(geometry.baseline > 1e-9)) return std::nullopt;
  const Eigen::Vector3d x_axis = along / geometry.baseline;
  const Eigen::Vector3d z_axis = AxisAcross(x_axis, cam1_from_world, cam2_from_world);
  geometry.world_from_rect << x_axis, z_axis.cross(x_axis), z_axis;
  geometry.camera1 = camera1;
  geometry.camera2 = camera2;
  geometry.cam1_from_rect = cam1_from_world.rotation * geometry.world_from_rect;
  geometry.cam2_from_rect = cam2_from_world.rotation * geometry.world_from_rect;

  const std::vector<Eigen::Vector3d> rays1 = RaysOf(camera1, geometry.cam1_from_rect);
  const bool on_plane = FitOnPlane(rays1) && FitOnPlane(RaysOf(camera2, geometry.cam2_from_rect));
  geometry.surface = on_plane ? RectSurface::kPlane : RectSurface::kMercator;
  geometry.focal = on_plane ? camera1.MeanFocal() : MercatorFocal(camera1, rays1);
  return geometry;
}

}  // namespace colmap_seapoint
