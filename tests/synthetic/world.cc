#include "tests/synthetic/world.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {

namespace {

constexpr double kExtent = 50;  // of a ground plane, to every side: beyond every picture

NoiseTexture WorldTexture() { return NoiseTexture(42, 0.16, 4); }

// Coordinates (a, b) of a point's foot on the rectangle's plane.
Eigen::Vector2d Inside(const Rectangle& rectangle, const Eigen::Vector3d& point) {
  const Eigen::Vector3d offset = point - rectangle.center;
  return {offset.dot(rectangle.half_u) / rectangle.half_u.squaredNorm(),
          offset.dot(rectangle.half_v) / rectangle.half_v.squaredNorm()};
}

}  // namespace

std::optional<Eigen::Vector3d> World::Cast(const Eigen::Vector3d& origin,
                                           const Eigen::Vector3d& direction) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Rectangle& rectangle : rectangles_) {
    const Eigen::Vector3d normal = rectangle.half_u.cross(rectangle.half_v);
    const double slope = normal.dot(direction);
    if (slope == 0) continue;
    const double t = normal.dot(rectangle.center - origin) / slope;
    if (!(t > 0) || t >= nearest) continue;
    const Eigen::Vector2d inside = Inside(rectangle, origin + t * direction);
    if (inside.cwiseAbs().maxCoeff() <= 1) nearest = t;
  }
  if (!std::isfinite(nearest)) return std::nullopt;
  return origin + nearest * direction;
}

double World::Distance(const Eigen::Vector3d& point) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Rectangle& rectangle : rectangles_) {
    const Eigen::Vector2d inside = Inside(rectangle, point).cwiseMax(-1).cwiseMin(1);
    const Eigen::Vector3d foot =
        rectangle.center + inside.x() * rectangle.half_u + inside.y() * rectangle.half_v;
    nearest = std::min(nearest, (point - foot).norm());
  }
  return nearest;
}

std::array<double, 3> World::ColorAt(const Eigen::Vector3d& point) const {
  const double red = std::clamp(127 + 100 * texture_.At(point), 0.0, 255.0);
  return {red, 30 + 0.75 * red, 255 - 0.5 * red};
}

Viewpoint StandAt(const Camera& camera, const Eigen::Vector3d& center,
                  const Eigen::Vector3d& turn_deg) {
  const Eigen::Vector3d turn = turn_deg * M_PI / 180;
  const Eigen::Quaterniond rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(turn.x(), Eigen::Vector3d::UnitX())) *
      Eigen::Quaterniond(Eigen::AngleAxisd(turn.y(), Eigen::Vector3d::UnitY())) *
      Eigen::Quaterniond(Eigen::AngleAxisd(turn.z(), Eigen::Vector3d::UnitZ()));
  return {camera, {rotation, -(rotation * center)}};
}

std::vector<CameraModel> RectifiableCameraModels() {
  std::vector<CameraModel> models;
  for (int id = 0; id < 100; ++id) {
    const CameraModelInfo* info = FindCameraModel(id);
    if (info && info->model != CameraModel::kEquirectangular) models.push_back(info->model);
  }
  return models;
}

Camera MildCamera(CameraModel model, double focal, int width, int height) {
  Camera camera = MakeCamera(model, focal, width, height);
  const size_t first = FindCameraModel(static_cast<int>(model))->has_single_focal ? 3 : 4;
  camera.params[first - 2] += 4.5;
  camera.params[first - 1] -= 3.25;
  std::vector<double> distortion;
  switch (model) {
    case CameraModel::kSimplePinhole:
    case CameraModel::kPinhole:
      break;
    case CameraModel::kSimpleRadial:
      distortion = {-0.1};
      break;
    case CameraModel::kRadial:
      distortion = {-0.12, 0.03};
      break;
    case CameraModel::kOpenCV:
      distortion = {-0.15, 0.05, 1.5e-3, -1e-3};
      break;
    case CameraModel::kOpenCVFisheye:
      distortion = {0.03, -0.01, 0.004, -0.001};
      break;
    case CameraModel::kFullOpenCV:
      distortion = {0.1, 0.05, 1e-3, -1e-3, 0.01, 0.2, 0.06, 0.01};
      break;
    case CameraModel::kFov:
      distortion = {0.6};
      break;
    case CameraModel::kSimpleRadialFisheye:
      distortion = {0.04};
      break;
    case CameraModel::kRadialFisheye:
      distortion = {0.04, -0.01};
      break;
    case CameraModel::kThinPrismFisheye:
      distortion = {0.02, -0.01, 1e-3, -1e-3, 0.003, -0.001, 1e-3, 1e-3};
      break;
    case CameraModel::kRadTanThinPrismFisheye:
      distortion = {0.02, -0.01, 0.003, -0.001, 5e-4, -1e-4, 1e-3, -1e-3, 1e-3, -5e-4, 1e-3, 5e-4};
      break;
    case CameraModel::kSimpleDivision:
    case CameraModel::kDivision:
      distortion = {-0.1};
      break;
    case CameraModel::kEucm:
      distortion = {0.55, 1.1};
      break;
    case CameraModel::kSimpleFisheye:
    case CameraModel::kFisheye:
    case CameraModel::kEquirectangular:
      break;
  }
  std::copy(distortion.begin(), distortion.end(),
            camera.params.begin() + static_cast<std::ptrdiff_t>(first));
  return camera;
}

ColorImage TakePicture(const World& world, const Viewpoint& viewpoint) {
  const Camera& camera = viewpoint.camera;
  ColorImage picture(camera.width, camera.height, 3);
  ParallelFor(2, camera.height, [&](int64_t row) {
    for (int x = 0; x < camera.width; ++x) {
      std::array<double, 3> sum = {0, 0, 0};
      for (int ray = 0; ray < 4; ++ray) {
        const Eigen::Vector2d pixel(x + 0.25 + 0.5 * (ray % 2),
                                    static_cast<double>(row) + 0.25 + 0.5 * (ray / 2));
        const auto point = SurfaceAt(world, viewpoint, pixel);
        if (!point) continue;
        const std::array<double, 3> color = world.ColorAt(*point);
        for (size_t c = 0; c < 3; ++c) sum[c] += color[c];
      }
      for (int c = 0; c < 3; ++c) {
        picture.At(x, static_cast<int>(row), c) =
            static_cast<uint8_t>(std::lround(sum[static_cast<size_t>(c)] / 4));
      }
    }
  });
  return picture;
}

std::optional<Eigen::Vector3d> SurfaceAt(const World& world, const Viewpoint& viewpoint,
                                         const Eigen::Vector2d& pixel) {
  const auto ray = viewpoint.camera.CamFromImg(pixel);
  if (!ray) return std::nullopt;
  return world.Cast(viewpoint.Center(),
                    viewpoint.cam_from_world.rotation.conjugate() * ray->homogeneous());
}

std::optional<Eigen::Vector2d> PixelOf(const World& world, const Viewpoint& viewpoint,
                                       const Eigen::Vector3d& point) {
  const auto pixel = viewpoint.camera.ImgFromCam(viewpoint.cam_from_world * point);
  if (!pixel || !viewpoint.camera.InImage(*pixel)) return std::nullopt;
  const auto seen = world.Cast(viewpoint.Center(), point - viewpoint.Center());
  if (!seen || (*seen - point).norm() > 1e-6) return std::nullopt;
  return pixel;
}

World FlatWorld(double depth) {
  return World({{{0, 0, depth}, {kExtent, 0, 0}, {0, kExtent, 0}}}, WorldTexture());
}

World SlantedWorld(double depth, double angle_deg) {
  const double angle = angle_deg * M_PI / 180;
  return World({{{0, 0, depth},
                 {kExtent * std::cos(angle), 0, -kExtent * std::sin(angle)},
                 {0, kExtent, 0}}},
               WorldTexture());
}

World StepWorld(double near_depth, double far_depth, int near_sign) {
  const double half = 0.5 * kExtent, rise = 0.5 * (far_depth - near_depth);
  return World({{{near_sign * half, 0, near_depth}, {half, 0, 0}, {0, kExtent, 0}},
                {{-near_sign * half, 0, far_depth}, {half, 0, 0}, {0, kExtent, 0}},
                {{0, 0, near_depth + rise}, {0, 0, rise}, {0, kExtent, 0}}},
               WorldTexture());
}

}  // namespace colmap_seapoint
