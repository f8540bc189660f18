// The lenses of camera.h as templates: over double where a point is projected, over numbers that
// carry their derivatives where a lens is adjusted (bundle_adjustment.h). Everything here works on
// the plane before the focal lengths. `p` are the parameters in COLMAP's order.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/camera.h"

namespace colmap_seapoint {

inline bool IsFisheye(CameraModel model) {
  return model == CameraModel::kOpenCVFisheye || model == CameraModel::kSimpleRadialFisheye ||
         model == CameraModel::kRadialFisheye || model == CameraModel::kThinPrismFisheye;
}

// A factor of the radius and its derivative by the squared radius.
template <typename T>
struct Radial {
  T factor;
  T derivative;
};

template <typename T>
Radial<T> Polynomial(const T& s, const T& k1, const T& k2 = T(0), const T& k3 = T(0),
                     const T& k4 = T(0)) {
  return {1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4))),
          k1 + s * (2.0 * k2 + s * (3.0 * k3 + s * 4.0 * k4))};
}

template <typename T>
Radial<T> Rational(const T& s, const T* p) {
  const Radial<T> numerator = Polynomial(s, p[4], p[5], p[8]);
  const Radial<T> denominator = Polynomial(s, p[9], p[10], p[11]);
  const T factor = numerator.factor / denominator.factor;
  return {factor, (numerator.derivative - factor * denominator.derivative) / denominator.factor};
}

// The three cases, their thresholds, and the sign of the first one are COLMAP's.
template <typename T>
Radial<T> FovFactor(const T& r2, const T& omega) {
  using std::atan;
  using std::sqrt;
  using std::tan;
  constexpr double kEpsilon = 1e-4;
  const T omega2 = omega * omega;
  if (omega2 < kEpsilon) return {omega2 * r2 / 3.0 - omega2 / 12.0 + 1.0, omega2 / 3.0};
  const T t = tan(omega / 2.0);
  if (r2 < kEpsilon) {
    return {-2.0 * t * (4.0 * r2 * t * t - 3.0) / (3.0 * omega), -8.0 * t * t * t / (3.0 * omega)};
  }
  const T r = sqrt(r2);
  const T a = 2.0 * t;
  const T factor = atan(r * a) / (r * omega);
  return {factor, (a / (1.0 + a * a * r2) / omega - factor) / (2.0 * r2)};
}

// Every model maps a point w of a plane (z = 1 for perspective models; the direction's angle from
// the axis for fisheye models) to radial(|w|^2) * w + tangential and prism terms.
template <typename T>
Radial<T> RadialFactor(CameraModel model, const T* p, const T& s) {
  switch (model) {
    case CameraModel::kSimplePinhole:
    case CameraModel::kPinhole:
      return {T(1), T(0)};
    case CameraModel::kSimpleRadial:
    case CameraModel::kSimpleRadialFisheye:
      return Polynomial(s, p[3]);
    case CameraModel::kRadial:
    case CameraModel::kRadialFisheye:
      return Polynomial(s, p[3], p[4]);
    case CameraModel::kOpenCV:
      return Polynomial(s, p[4], p[5]);
    case CameraModel::kOpenCVFisheye:
      return Polynomial(s, p[4], p[5], p[6], p[7]);
    case CameraModel::kFullOpenCV:
      return Rational(s, p);
    case CameraModel::kFov:
      return FovFactor(s, p[4]);
    case CameraModel::kThinPrismFisheye:
      return Polynomial(s, p[4], p[5], p[8], p[9]);
  }
  return {T(1), T(0)};
}

inline bool HasTangential(CameraModel model) {
  return model == CameraModel::kOpenCV || model == CameraModel::kFullOpenCV ||
         model == CameraModel::kThinPrismFisheye;
}

template <typename T>
Eigen::Matrix<T, 2, 1> Distort(CameraModel model, const T* p, const Eigen::Matrix<T, 2, 1>& w) {
  const T u = w.x(), v = w.y(), s = u * u + v * v;
  Eigen::Matrix<T, 2, 1> d = RadialFactor(model, p, s).factor * w;
  if (HasTangential(model)) {
    d.x() += 2.0 * p[6] * u * v + p[7] * (s + 2.0 * u * u);
    d.y() += 2.0 * p[7] * u * v + p[6] * (s + 2.0 * v * v);
  }
  if (model == CameraModel::kThinPrismFisheye) d += s * Eigen::Matrix<T, 2, 1>(p[10], p[11]);
  return d;
}

// Of a direction in the camera frame, z > 0: pixel = focal lengths * this + principal point.
template <typename T>
Eigen::Matrix<T, 2, 1> DistortedDirection(CameraModel model, const T* p,
                                          const Eigen::Matrix<T, 3, 1>& direction) {
  using std::atan;
  using std::sqrt;
  Eigen::Matrix<T, 2, 1> w(direction.x() / direction.z(), direction.y() / direction.z());
  if (IsFisheye(model)) {
    const T r2 = w.squaredNorm();
    constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
    if (r2 > kEpsilon * kEpsilon) {
      const T r = sqrt(r2);
      const T factor = atan(r) / r;
      w *= factor;
    }
  }
  return Distort(model, p, w);
}

}  // namespace colmap_seapoint
