#include "examples/benchmarks/map/color_difference.h"

#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTwentyFiveTo7 = 6103515625.0;

double Degrees(double radians) { return radians * 180 / kPi; }
double Radians(double degrees) { return degrees * kPi / 180; }

double LabCurve(double t) {
  return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116;
}

double Hue(double a, double b) {
  if (a == 0 && b == 0) return 0;
  const double hue = Degrees(std::atan2(b, a));
  return hue < 0 ? hue + 360 : hue;
}

// Equation 10: the difference of hues in (-180, 180].
double HueDifference(double h1, double h2) {
  const double difference = h2 - h1;
  if (difference > 180) return difference - 360;
  return difference < -180 ? difference + 360 : difference;
}

// Equation 14.
double MeanHue(double h1, double h2) {
  if (std::abs(h1 - h2) <= 180) return (h1 + h2) / 2;
  return h1 + h2 < 360 ? (h1 + h2 + 360) / 2 : (h1 + h2 - 360) / 2;
}

}  // namespace

Eigen::Vector3d LabFromLinear(const Eigen::Array3d& rgb) {
  Eigen::Matrix3d xyz_from_rgb;
  xyz_from_rgb << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339,
      0.1191920, 0.9503041;
  const Eigen::Vector3d white = xyz_from_rgb * Eigen::Vector3d::Ones();
  const Eigen::Vector3d xyz = xyz_from_rgb * rgb.matrix();
  const double x = LabCurve(xyz[0] / white[0]), y = LabCurve(xyz[1] / white[1]),
               z = LabCurve(xyz[2] / white[2]);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double DeltaE2000(const Eigen::Vector3d& lab1, const Eigen::Vector3d& lab2) {
  const double c_mean = (lab1.tail<2>().norm() + lab2.tail<2>().norm()) / 2;
  const double c7 = std::pow(c_mean, 7);
  const double g = 0.5 * (1 - std::sqrt(c7 / (c7 + kTwentyFiveTo7)));
  const double a1 = (1 + g) * lab1[1], a2 = (1 + g) * lab2[1];
  const double c1 = std::hypot(a1, lab1[2]), c2 = std::hypot(a2, lab2[2]);
  const double h1 = Hue(a1, lab1[2]), h2 = Hue(a2, lab2[2]);
  const bool is_gray = c1 * c2 == 0;
  const double dh = is_gray ? 0 : HueDifference(h1, h2);
  const double d_l = lab2[0] - lab1[0], d_c = c2 - c1;
  const double d_h = 2 * std::sqrt(c1 * c2) * std::sin(Radians(dh / 2));
  const double l = (lab1[0] + lab2[0]) / 2, c = (c1 + c2) / 2;
  const double h = is_gray ? h1 + h2 : MeanHue(h1, h2);
  const double t = 1 - 0.17 * std::cos(Radians(h - 30)) + 0.24 * std::cos(Radians(2 * h)) +
                   0.32 * std::cos(Radians(3 * h + 6)) - 0.20 * std::cos(Radians(4 * h - 63));
  const double turn = 30 * std::exp(-std::pow((h - 275) / 25, 2));
  const double mean7 = std::pow(c, 7);
  const double r_c = 2 * std::sqrt(mean7 / (mean7 + kTwentyFiveTo7));
  const double l50 = std::pow(l - 50, 2);
  const double s_l = 1 + 0.015 * l50 / std::sqrt(20 + l50);
  const double s_c = 1 + 0.045 * c, s_h = 1 + 0.015 * c * t;
  const double l_term = d_l / s_l, c_term = d_c / s_c, h_term = d_h / s_h;
  return std::sqrt(l_term * l_term + c_term * c_term + h_term * h_term -
                   std::sin(Radians(2 * turn)) * r_c * c_term * h_term);
}

}  // namespace colmap_seapoint
