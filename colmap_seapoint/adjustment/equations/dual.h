// A number with its derivatives by N variables (forward differentiation): what the lenses of
// base/camera_projection.h are evaluated with, so that each lens's formula stands there only once.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace colmap_seapoint {

template <int N>
struct Dual {
  using Derivatives = Eigen::Matrix<double, N, 1>;

  Dual(double constant = 0)
      : value(constant), by(Derivatives::Zero()) {}  // NOLINT: a number is one
  Dual(double v, const Derivatives& d) : value(v), by(d) {}

  static Dual Variable(double v, int idx) { return {v, Derivatives::Unit(idx)}; }

  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  Dual& operator*=(const Dual& b) { return *this = *this * b; }

  double value;
  Derivatives by;
};

template <int N>
Dual<N> operator+(const Dual<N>& a, const Dual<N>& b) {
  return {a.value + b.value, a.by + b.by};
}
template <int N>
Dual<N> operator+(double a, const Dual<N>& b) {
  return {a + b.value, b.by};
}
template <int N>
Dual<N> operator+(const Dual<N>& a, double b) {
  return {a.value + b, a.by};
}
template <int N>
Dual<N> operator-(const Dual<N>& a) {
  return {-a.value, -a.by};
}
template <int N>
Dual<N> operator-(const Dual<N>& a, const Dual<N>& b) {
  return {a.value - b.value, a.by - b.by};
}
template <int N>
Dual<N> operator-(double a, const Dual<N>& b) {
  return {a - b.value, -b.by};
}
template <int N>
Dual<N> operator-(const Dual<N>& a, double b) {
  return {a.value - b, a.by};
}
template <int N>
Dual<N> operator*(const Dual<N>& a, const Dual<N>& b) {
  return {a.value * b.value, b.value * a.by + a.value * b.by};
}
template <int N>
Dual<N> operator*(double a, const Dual<N>& b) {
  return {a * b.value, a * b.by};
}
template <int N>
Dual<N> operator*(const Dual<N>& a, double b) {
  return b * a;
}
template <int N>
Dual<N> operator/(const Dual<N>& a, const Dual<N>& b) {
  const double quotient = a.value / b.value;
  return {quotient, (a.by - quotient * b.by) / b.value};
}
template <int N>
Dual<N> operator/(double a, const Dual<N>& b) {
  const double quotient = a / b.value;
  return {quotient, b.by * (-quotient / b.value)};
}
template <int N>
Dual<N> operator/(const Dual<N>& a, double b) {
  return {a.value / b, a.by / b};
}

template <int N>
bool operator<(const Dual<N>& a, double b) {
  return a.value < b;
}
template <int N>
bool operator>(const Dual<N>& a, double b) {
  return a.value > b;
}

template <int N>
Dual<N> sqrt(const Dual<N>& a) {
  const double root = std::sqrt(a.value);
  return {root, a.by / (2 * root)};
}
template <int N>
Dual<N> atan(const Dual<N>& a) {
  return {std::atan(a.value), a.by / (1 + a.value * a.value)};
}
template <int N>
Dual<N> tan(const Dual<N>& a) {
  const double t = std::tan(a.value);
  return {t, a.by * (1 + t * t)};
}

}  // namespace colmap_seapoint

template <int N>
struct Eigen::NumTraits<colmap_seapoint::Dual<N>> : Eigen::NumTraits<double> {
  using Real = colmap_seapoint::Dual<N>;
  using NonInteger = colmap_seapoint::Dual<N>;
  using Nested = colmap_seapoint::Dual<N>;
  using Literal = colmap_seapoint::Dual<N>;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1 };
};
