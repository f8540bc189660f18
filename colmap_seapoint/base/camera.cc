#include "colmap_seapoint/base/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/camera_projection.h"
#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr double kHalfPi = 1.57079632679489661923;

constexpr std::array<CameraModelInfo, 18> kModels = {{
    {CameraModel::kSimplePinhole, "SIMPLE_PINHOLE", 3, true},
    {CameraModel::kPinhole, "PINHOLE", 4, false},
    {CameraModel::kSimpleRadial, "SIMPLE_RADIAL", 4, true},
    {CameraModel::kRadial, "RADIAL", 5, true},
    {CameraModel::kOpenCV, "OPENCV", 8, false},
    {CameraModel::kOpenCVFisheye, "OPENCV_FISHEYE", 8, false},
    {CameraModel::kFullOpenCV, "FULL_OPENCV", 12, false},
    {CameraModel::kFov, "FOV", 5, false},
    {CameraModel::kSimpleRadialFisheye, "SIMPLE_RADIAL_FISHEYE", 4, true},
    {CameraModel::kRadialFisheye, "RADIAL_FISHEYE", 5, true},
    {CameraModel::kThinPrismFisheye, "THIN_PRISM_FISHEYE", 12, false},
    {CameraModel::kRadTanThinPrismFisheye, "RAD_TAN_THIN_PRISM_FISHEYE", 16, false},
    {CameraModel::kSimpleDivision, "SIMPLE_DIVISION", 4, true},
    {CameraModel::kDivision, "DIVISION", 5, false},
    {CameraModel::kSimpleFisheye, "SIMPLE_FISHEYE", 3, true},
    {CameraModel::kFisheye, "FISHEYE", 4, false},
    {CameraModel::kEucm, "EUCM", 6, false},
    {CameraModel::kEquirectangular, "EQUIRECTANGULAR", 2, false},
}};

bool HasSingleFocal(CameraModel model) {
  return kModels[static_cast<size_t>(model)].has_single_focal;
}

Eigen::Matrix2d DistortJacobian(CameraModel model, const double* p, const Eigen::Vector2d& w) {
  const Radial<double> radial = RadialFactor(model, p, w.squaredNorm());
  const Eigen::Matrix2d jacobian =
      radial.factor * Eigen::Matrix2d::Identity() + 2 * radial.derivative * w * w.transpose();
  const Aside<double> aside = AsideOf(model, p);
  if (!AsideIsOfRadial(model)) return jacobian + aside.Jacobian(w);
  return (Eigen::Matrix2d::Identity() + aside.Jacobian(radial.factor * w)) * jacobian;
}

// Newton with step halving. Leaves *w where the residual stopped falling; returns the residual.
double SolveFrom(CameraModel model, const double* p, const Eigen::Vector2d& target,
                 Eigen::Vector2d* w) {
  Eigen::Vector2d residual = Distort(model, p, *w) - target;
  for (int iteration = 0; iteration < 50 && residual.norm() > 1e-15; ++iteration) {
    const Eigen::Matrix2d jacobian = DistortJacobian(model, p, *w);
    if (!(std::abs(jacobian.determinant()) > 1e-14)) break;
    const Eigen::Vector2d step = jacobian.inverse() * residual;
    double fraction = 1;
    Eigen::Vector2d next, next_residual;
    do {
      next = *w - fraction * step;
      next_residual = Distort(model, p, next) - target;
      fraction *= 0.5;
    } while (!(next_residual.norm() < residual.norm()) && fraction > 1e-4);
    if (!(next_residual.norm() < residual.norm())) break;
    *w = next;
    residual = next_residual;
  }
  return residual.norm();
}

// False when the lens folds back somewhere between the axis and w: w is then a false solution.
bool OnPrincipalBranch(CameraModel model, const double* p, const Eigen::Vector2d& w) {
  for (int i = 1; i <= 16; ++i) {
    const double determinant = DistortJacobian(model, p, w * (i / 16.0)).determinant();
    if (!(determinant > 0)) return false;
  }
  return true;
}

Eigen::Vector2d FirstGuess(CameraModel model, const double* p, const Eigen::Vector2d& target) {
  const double radius = target.norm();
  if (model != CameraModel::kFov || radius < 1e-6 || std::abs(p[4]) < 1e-2) return target;
  const double angle = std::min(std::abs(radius * p[4]), kHalfPi - 1e-4);
  return target * (std::tan(angle) / (2 * std::tan(std::abs(p[4]) / 2) * radius));
}

// tolerance: in the units of the plane. nullopt when the target is not reached.
std::optional<Eigen::Vector2d> Undistort(CameraModel model, const double* p,
                                         const Eigen::Vector2d& target, double tolerance) {
  Eigen::Vector2d w = FirstGuess(model, p, target);
  if (SolveFrom(model, p, target, &w) < tolerance && OnPrincipalBranch(model, p, w)) return w;
  // Follow the solution outwards from the axis, where it is known.
  w.setZero();
  constexpr int kNumSteps = 64;
  for (int i = 1; i <= kNumSteps; ++i) {
    if (!(SolveFrom(model, p, target * (i / double{kNumSteps}), &w) < tolerance)) {
      return std::nullopt;
    }
  }
  if (!OnPrincipalBranch(model, p, w)) return std::nullopt;
  return w;
}

// Longitude and latitude (downwards) of a point of the plane z = 1, radians, and back: nullopt for
// what lies aside or behind.
Eigen::Vector2d AnglesOf(const Eigen::Vector2d& w) {
  return {std::atan(w.x()), std::atan2(w.y(), std::hypot(w.x(), 1.0))};
}
std::optional<Eigen::Vector2d> PointAtAngles(const Eigen::Vector2d& angles) {
  if (!(angles.cwiseAbs().maxCoeff() < kHalfPi - 1e-9)) return std::nullopt;
  return Eigen::Vector2d(std::tan(angles.x()), std::tan(angles.y()) / std::cos(angles.x()));
}

}  // namespace

const CameraModelInfo* FindCameraModel(int model_id) {
  if (model_id < 0 || model_id >= static_cast<int>(kModels.size())) return nullptr;
  return &kModels[static_cast<size_t>(model_id)];
}

const CameraModelInfo* FindCameraModel(const std::string& name) {
  for (const CameraModelInfo& info : kModels) {
    if (name == info.name) return &info;
  }
  return nullptr;
}

std::string CameraModelNames() {
  std::string names;
  for (const CameraModelInfo& info : kModels) {
    if (!names.empty()) names += ", ";
    names += info.name;
  }
  return names;
}

double Camera::FocalX() const {
  return model == CameraModel::kEquirectangular ? params[0] / (4 * kHalfPi) : params[0];
}
double Camera::FocalY() const {
  if (model == CameraModel::kEquirectangular) return params[1] / (2 * kHalfPi);
  return params[HasSingleFocal(model) ? 0 : 1];
}
double Camera::PrincipalX() const {
  if (model == CameraModel::kEquirectangular) return params[0] / 2;
  return params[HasSingleFocal(model) ? 1 : 2];
}
double Camera::PrincipalY() const {
  if (model == CameraModel::kEquirectangular) return params[1] / 2;
  return params[HasSingleFocal(model) ? 2 : 3];
}

std::optional<Eigen::Vector2d> Camera::ImgFromCam(const Eigen::Vector3d& point_in_cam) const {
  if (!(point_in_cam.z() > 0)) return std::nullopt;
  const Eigen::Vector2d d = model == CameraModel::kEquirectangular
                                ? AnglesOf(point_in_cam.head<2>() / point_in_cam.z())
                                : DistortedDirection(model, params.data(), point_in_cam);
  const Eigen::Vector2d pixel(FocalX() * d.x() + PrincipalX(), FocalY() * d.y() + PrincipalY());
  if (!pixel.allFinite()) return std::nullopt;
  return pixel;
}

std::optional<Eigen::Vector2d> Camera::CamFromImg(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d target((pixel.x() - PrincipalX()) / FocalX(),
                               (pixel.y() - PrincipalY()) / FocalY());
  if (!target.allFinite()) return std::nullopt;
  if (model == CameraModel::kEquirectangular) return PointAtAngles(target);
  const double tolerance = 1e-3 / std::max(std::abs(FocalX()), std::abs(FocalY()));
  const std::optional<Eigen::Vector2d> w = Undistort(model, params.data(), target, tolerance);
  if (!w || !w->allFinite()) return std::nullopt;
  if (!IsFisheye(model)) return w;
  const double theta = w->norm();
  if (theta > kHalfPi - 1e-9) return std::nullopt;
  if (theta < std::numeric_limits<double>::epsilon()) return w;
  return Eigen::Vector2d(*w * (std::tan(theta) / theta));
}

bool AreScaledSizes(int width1, int height1, int width2, int height2) {
  if (std::min({width1, height1, width2, height2}) <= 0) return false;
  if (width1 == width2 || height1 == height2) return width1 == width2 && height1 == height2;
  // Each side of the smaller picture is within one pixel of k times that of the larger one.
  const double width = std::max(width1, width2), height = std::max(height1, height2);
  if ((width1 < width2) != (height1 < height2)) return false;
  const double k_of_width = std::min(width1, width2) / width;
  const double k_of_height = std::min(height1, height2) / height;
  return std::abs(k_of_width - k_of_height) <= 1 / width + 1 / height;
}

Camera ScaledCamera(const Camera& camera, int width, int height) {
  SEAPOINT_CHECK(AreScaledSizes(camera.width, camera.height, width, height));
  const double x_scale = static_cast<double>(width) / camera.width;
  const double y_scale = static_cast<double>(height) / camera.height;
  Camera scaled = camera;
  scaled.width = width;
  scaled.height = height;
  const bool single = HasSingleFocal(camera.model);
  if (camera.model == CameraModel::kEquirectangular) {
    scaled.params = {x_scale * camera.params[0], y_scale * camera.params[1]};
    return scaled;
  }
  scaled.params[0] *= single ? 0.5 * (x_scale + y_scale) : x_scale;
  if (!single) scaled.params[1] *= y_scale;
  const size_t principal = single ? 1 : 2;
  scaled.params[principal] *= x_scale;
  scaled.params[principal + 1] *= y_scale;
  return scaled;
}

Camera MakeCamera(CameraModel model, double focal, int width, int height) {
  const CameraModelInfo& info = kModels[static_cast<size_t>(model)];
  Camera camera;
  camera.model = model;
  camera.width = width;
  camera.height = height;
  camera.params.assign(static_cast<size_t>(info.num_params), 0.0);
  if (model == CameraModel::kEquirectangular) {
    camera.params = {static_cast<double>(width), static_cast<double>(height)};
    return camera;
  }
  size_t i = 0;
  camera.params[i++] = focal;
  if (!info.has_single_focal) camera.params[i++] = focal;
  camera.params[i++] = width / 2.0;
  camera.params[i] = height / 2.0;
  if (model == CameraModel::kFov) camera.params[4] = 1e-2;  // COLMAP's: 0 is singular
  if (model == CameraModel::kEucm) camera.params[5] = 1;    // COLMAP's too: a pinhole
  return camera;
}

}  // namespace colmap_seapoint
