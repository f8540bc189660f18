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
         model == CameraModel::kRadialFisheye || model == CameraModel::kThinPrismFisheye ||
         model == CameraModel::kRadTanThinPrismFisheye || model == CameraModel::kSimpleFisheye ||
         model == CameraModel::kFisheye;
}

// A factor of the radius and its derivative by the squared radius.
template <typename T>
struct Radial {
  T factor;
  T derivative;
};

template <typename T>
Radial<T> Polynomial(const T& s, const T& k1, const T& k2 = T(0), const T& k3 = T(0),
                     const T& k4 = T(0), const T& k5 = T(0), const T& k6 = T(0)) {
  return {1.0 + s * (k1 + s * (k2 + s * (k3 + s * (k4 + s * (k5 + s * k6))))),
          k1 + s * (2.0 * k2 + s * (3.0 * k3 + s * (4.0 * k4 + s * (5.0 * k5 + s * 6.0 * k6))))};
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

// The smaller root of k |w|^2 f^2 - f + 1 = 0: f w lies where f w / (1 + k |f w|^2) is w. Not a
// number where there is none.
template <typename T>
Radial<T> DivisionFactor(const T& s, const T& k) {
  using std::sqrt;
  const T root = sqrt(1.0 - 4.0 * k * s);
  return {2.0 / (1.0 + root), 4.0 * k / (root * (1.0 + root) * (1.0 + root))};
}

template <typename T>
Radial<T> EucmFactor(const T& s, const T& alpha, const T& beta) {
  using std::sqrt;
  const T root = sqrt(beta * s + 1.0);
  const T factor = 1.0 / (alpha * root + 1.0 - alpha);
  return {factor, -alpha * beta / (2.0 * root) * factor * factor};
}

// Every model maps a point w of a plane (z = 1 for perspective models; the direction's angle from
// the axis for fisheye models) to radial(|w|^2) * w + tangential and prism terms; these are of w,
// for kRadTanThinPrismFisheye of radial(|w|^2) * w.
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
    case CameraModel::kRadTanThinPrismFisheye:
      return Polynomial(s, p[4], p[5], p[6], p[7], p[8], p[9]);
    case CameraModel::kSimpleDivision:
      return DivisionFactor(s, p[3]);
    case CameraModel::kDivision:
      return DivisionFactor(s, p[4]);
    case CameraModel::kEucm:
      return EucmFactor(s, p[4], p[5]);
    case CameraModel::kSimpleFisheye:
    case CameraModel::kFisheye:
    case CameraModel::kEquirectangular:
      break;
  }
  return {T(1), T(0)};
}

// The shift that a lens adds to a point: by decentred lenses (Brown's p1, p2), and by tilted ones,
// of the squared radius (s1) and of its square (s2).
template <typename T>
struct Aside {
  using Vector2 = Eigen::Matrix<T, 2, 1>;
  using Matrix2 = Eigen::Matrix<T, 2, 2>;

  T p1 = T(0), p2 = T(0);
  Vector2 s1 = Vector2::Zero(), s2 = Vector2::Zero();

  Vector2 Of(const Vector2& w) const {
    const T& u = w.x();
    const T& v = w.y();
    const T s = w.squaredNorm();
    const Vector2 tangential(2.0 * p1 * u * v + p2 * (s + 2.0 * u * u),
                             2.0 * p2 * u * v + p1 * (s + 2.0 * v * v));
    return tangential + s * s1 + s * s * s2;
  }
  Matrix2 Jacobian(const Vector2& w) const {
    const T u = w.x(), v = w.y(), s = w.squaredNorm();
    Matrix2 tangential;
    tangential << 2.0 * p1 * v + 6.0 * p2 * u, 2.0 * p1 * u + 2.0 * p2 * v,  //
        2.0 * p2 * v + 2.0 * p1 * u, 2.0 * p2 * u + 6.0 * p1 * v;
    return tangential + 2.0 * (s1 + 2.0 * s * s2) * w.transpose();
  }
};

template <typename T>
Aside<T> AsideOf(CameraModel model, const T* p) {
  switch (model) {
    case CameraModel::kOpenCV:
    case CameraModel::kFullOpenCV:
      return {p[6], p[7]};
    case CameraModel::kThinPrismFisheye:
      return {p[6], p[7], {p[10], p[11]}};
    case CameraModel::kRadTanThinPrismFisheye:  // its p0 is the others' p2
      return {p[11], p[10], {p[12], p[14]}, {p[13], p[15]}};
    default:
      return {};
  }
}

inline bool AsideIsOfRadial(CameraModel model) {
  return model == CameraModel::kRadTanThinPrismFisheye;
}

template <typename T>
Eigen::Matrix<T, 2, 1> Distort(CameraModel model, const T* p, const Eigen::Matrix<T, 2, 1>& w) {
  const Eigen::Matrix<T, 2, 1> d = RadialFactor<T>(model, p, w.squaredNorm()).factor * w;
  return d + AsideOf(model, p).Of(AsideIsOfRadial(model) ? d : w);
}

// Of a direction in the camera frame, z > 0, by any model but kEquirectangular: pixel = focal
// lengths * this + principal point.
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
