#include "examples/survey/paths/survey_port.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "examples/survey/paths/survey_camera.h"

namespace colmap_seapoint {
namespace {

using Eigen::Vector3d;

constexpr double kRadPerDeg = 3.14159265358979323846 / 180;
constexpr double kMaxAngle = 89.9 * kRadPerDeg;
constexpr double kDomeBracket = 0.6;  // radians; a dome turns rays by less

// The lens whose picture through a flat port is, near the axis, that of `in_water`: what it sees is
// at angles larger by the index.
Camera LensInAir(PortKind kind, Camera camera) {
  if (kind != PortKind::kFlat) return camera;
  std::vector<double>& p = camera.params;
  p[0] /= kWaterIndex;
  p[1] /= kWaterIndex;
  if (camera.model == CameraModel::kOpenCVFisheye) {
    for (size_t k = 4; k < 8; ++k) p[k] /= std::pow(kWaterIndex, 2 * (static_cast<int>(k) - 3));
    return camera;
  }
  p[4] /= std::pow(kWaterIndex, 2);
  p[5] /= std::pow(kWaterIndex, 4);
  p[6] /= kWaterIndex;
  p[7] /= kWaterIndex;
  return camera;
}

// Snell's law: direction and normal are of unit length, the normal with the ray; `ratio` is the
// index before over that behind. nullopt where all light is thrown back.
std::optional<Vector3d> RefractAt(const Vector3d& direction, const Vector3d& normal, double ratio) {
  const double cosine = direction.dot(normal);
  const double rest = 1 - ratio * ratio * (1 - cosine * cosine);
  if (rest < 0) return std::nullopt;
  return Vector3d(ratio * direction + (std::sqrt(rest) - ratio * cosine) * normal);
}

// Where a ray from inside leaves a sphere around the origin.
Vector3d LeaveSphere(const Vector3d& from, const Vector3d& direction, double radius) {
  const double along = from.dot(direction);
  return from +
         (-along + std::sqrt(along * along + radius * radius - from.squaredNorm())) * direction;
}

}  // namespace

PortCamera::PortCamera(const PortOptions& port, const Camera& in_water)
    : port_(port),
      in_water_(in_water),
      lens_(LensInAir(port.kind, in_water)),
      max_tangent_(MaxTangent(lens_)),
      axis_(Vector3d::UnitZ()),
      centre_(port.sideways, 0, port.decentring) {
  const double tilt = port.tilt_deg * kRadPerDeg;
  if (port.kind == PortKind::kFlat) axis_ = {std::sin(tilt), 0, std::cos(tilt)};
  if (port.kind == PortKind::kDome && centre_.norm() > 0) axis_ = centre_.normalized();
  MeasureReach();
}

// By the rays of the picture's border; without a bound where some of it is black.
void PortCamera::MeasureReach() {
  constexpr int kSteps = 8;
  constexpr double kMargin = 1.1;
  for (int k = 0; k < (kSteps + 1) * (kSteps + 1); ++k) {
    const auto ray = Ray({in_water_.width * double(k % (kSteps + 1)) / kSteps,
                          in_water_.height * double(k / (kSteps + 1)) / kSteps});
    if (!ray) slope_ = std::numeric_limits<double>::infinity();
    if (!ray) return;
    slope_ = std::max(slope_, kMargin * ray->direction.head<2>().norm());
    reach_ = std::max(reach_, kMargin * ray->origin.norm());
  }
}

bool PortCamera::MayHold(const Vector3d& centre, double radius) const {
  const double reach = reach_ + slope_ * std::max(0.0, centre.z() + radius) + radius;
  return !(centre.head<2>().squaredNorm() > reach * reach);
}

std::optional<WaterRay> PortCamera::Refract(const Vector3d& in_air) const {
  const bool is_dome = port_.kind == PortKind::kDome;
  Vector3d place = Vector3d::Zero(), direction = in_air.normalized(), normal = axis_;
  const auto pass = [&](double outwards, double ratio) {
    if (is_dome) {
      place = centre_ + LeaveSphere(place - centre_, direction, outwards);
      normal = (place - centre_) / outwards;
    } else {
      const double approach = direction.dot(axis_);
      if (!(approach > 0)) return false;
      place += (outwards - place.dot(axis_)) / approach * direction;
    }
    const auto refracted = RefractAt(direction, normal, ratio);
    if (refracted) direction = *refracted;
    return refracted.has_value();
  };
  const double inner = is_dome ? port_.radius - port_.thickness : port_.distance;
  if (!pass(inner, 1 / kGlassIndex)) return std::nullopt;
  if (!pass(inner + port_.thickness, kGlassIndex / kWaterIndex)) return std::nullopt;
  if (!(direction.z() > 0)) return std::nullopt;
  return WaterRay{place, direction / direction.z()};
}

std::optional<WaterRay> PortCamera::Ray(const Eigen::Vector2d& pixel) const {
  const auto in_air = lens_.CamFromImg(pixel);
  if (!in_air) return std::nullopt;
  if (port_.kind == PortKind::kNone) return WaterRay{Vector3d::Zero(), in_air->homogeneous()};
  return Refract(in_air->homogeneous());
}

// How far, across the ray and in the plane of axis and point, the point lies outside of the ray
// that leaves the pupil at an angle to the axis; where no ray passes, the point lies inside.
double PortCamera::Miss(const Vector3d& across, double angle, const Vector3d& point) const {
  const auto ray = Refract(std::cos(angle) * axis_ + std::sin(angle) * across);
  if (!ray) return -1;
  const Vector3d direction = ray->direction.normalized(), to_point = point - ray->origin;
  return direction.dot(axis_) * to_point.dot(across) - direction.dot(across) * to_point.dot(axis_);
}

// The farther from the axis a ray leaves the pupil, the farther out it passes: one zero of Miss,
// found between bounds by false position (Illinois).
std::optional<Vector3d> PortCamera::DirectionInAir(const Vector3d& point) const {
  const Vector3d outwards = point - point.dot(axis_) * axis_;
  if (outwards.norm() < 1e-12 * point.norm()) return axis_;
  const Vector3d across = outwards.normalized();
  const double straight = std::atan2(outwards.norm(), point.dot(axis_));
  const bool is_flat = port_.kind == PortKind::kFlat;
  double low = is_flat ? straight : std::max(0.0, straight - kDomeBracket);
  double high = is_flat ? kMaxAngle : straight + kDomeBracket;
  double miss_low = Miss(across, low, point), miss_high = Miss(across, high, point);
  if (miss_low < 0 || miss_high > 0) return std::nullopt;
  const double tolerance = 1e-13 * point.norm();
  double angle = low;
  for (int side = 0, step = 0; step < 100 && miss_low > miss_high; ++step) {
    angle = (low * miss_high - high * miss_low) / (miss_high - miss_low);
    const double miss = Miss(across, angle, point);
    if (std::abs(miss) < tolerance) break;
    if (miss > 0) {
      low = angle, miss_low = miss;
      if (std::exchange(side, 1) == 1) miss_high *= 0.5;
    } else {
      high = angle, miss_high = miss;
      if (std::exchange(side, -1) == -1) miss_low *= 0.5;
    }
  }
  return Vector3d(std::cos(angle) * axis_ + std::sin(angle) * across);
}

std::optional<Eigen::Vector2d> PortCamera::ImgFromCam(const Vector3d& point) const {
  if (!MayHold(point, 0)) return std::nullopt;
  std::optional<Vector3d> direction = point;
  if (port_.kind == PortKind::kFlat &&
      !(point.dot(axis_) > port_.distance + port_.thickness && point.z() > 0)) {
    return std::nullopt;
  }
  if (port_.kind == PortKind::kDome && !((point - centre_).norm() > port_.radius)) {
    return std::nullopt;
  }
  if (port_.kind != PortKind::kNone) direction = DirectionInAir(point);
  if (!direction || direction->z() <= 0 ||
      direction->head<2>().norm() > max_tangent_ * direction->z()) {
    return std::nullopt;
  }
  return lens_.ImgFromCam(*direction);
}

}  // namespace colmap_seapoint
