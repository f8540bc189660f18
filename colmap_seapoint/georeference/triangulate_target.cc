#include "colmap_seapoint/georeference/triangulate_target.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace colmap_seapoint {
namespace {

constexpr double kMinRayAngle = 0.5 * 3.14159265358979323846 / 180;
constexpr int kMaxIterations = 20;
// Rays that are paired for the start: of more views, so many that lie evenly among them.
constexpr size_t kMaxRays = 60;
constexpr int kMaxRounds = 5;

struct Ray {
  Eigen::Vector3d origin, direction;  // world; unit length
};

std::optional<Ray> RayOf(const TargetView& view) {
  const auto on_plane = view.camera->CamFromImg(view.pixel);
  if (!on_plane) return std::nullopt;
  const Eigen::Vector3d in_cam(on_plane->x(), on_plane->y(), 1);
  return Ray{view.cam_from_world.OriginInSource(),
             (view.cam_from_world.rotation.conjugate() * in_cam).normalized()};
}

// The middle between the two places where the rays are nearest to each other; nullopt where that is
// not in front of both cameras, or the rays are too nearly parallel.
std::optional<Eigen::Vector3d> Meet(const Ray& a, const Ray& b) {
  if (a.direction.cross(b.direction).norm() < std::sin(kMinRayAngle)) return std::nullopt;
  const double cosine = a.direction.dot(b.direction);
  const Eigen::Vector3d between = b.origin - a.origin;
  const double sine2 = 1 - cosine * cosine;
  const double along_a = (between.dot(a.direction) - cosine * between.dot(b.direction)) / sine2;
  const double along_b = (cosine * between.dot(a.direction) - between.dot(b.direction)) / sine2;
  if (along_a <= 0 || along_b <= 0) return std::nullopt;
  return 0.5 * (a.origin + along_a * a.direction + b.origin + along_b * b.direction);
}

Eigen::Vector2d Residual(const TargetView& view, const Eigen::Vector3d& xyz) {
  const auto pixel = view.camera->ImgFromCam(view.cam_from_world * xyz);
  if (!pixel) return Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  return *pixel - view.pixel;
}

double Error(const TargetView& view, const Eigen::Vector3d& xyz) {
  return Residual(view, xyz).norm();
}

// How many pixels the projection moves a model unit. By central differences, so that none of the 18
// lens models needs a derivative of its own.
Eigen::Matrix<double, 2, 3> Derivative(const TargetView& view, const Eigen::Vector3d& xyz) {
  const double step = 1e-5 * (view.cam_from_world * xyz).norm();
  Eigen::Matrix<double, 2, 3> derivative;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d move = step * Eigen::Vector3d::Unit(i);
    derivative.col(i) = (Residual(view, xyz + move) - Residual(view, xyz - move)) / (2 * step);
  }
  return derivative;
}

// Gauss-Newton over the used views; false when it leaves the cameras' view.
bool Refine(const std::vector<TargetView>& views, TriangulatedTarget* target) {
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < views.size(); ++i) {
      if (!target->is_used[i]) continue;
      const Eigen::Matrix<double, 2, 3> derivative = Derivative(views[i], target->xyz);
      normal += derivative.transpose() * derivative;
      right -= derivative.transpose() * Residual(views[i], target->xyz);
    }
    const Eigen::Vector3d step = normal.ldlt().solve(right);
    if (!step.allFinite()) return false;
    target->xyz += step;
    target->covariance = normal.inverse();
    if (step.norm() < 1e-13 * (1 + target->xyz.norm())) break;
  }
  return target->xyz.allFinite() && target->covariance.allFinite();
}

void Judge(const std::vector<TargetView>& views, double max_error, TriangulatedTarget* target) {
  target->errors.clear();
  target->is_used.clear();
  for (const TargetView& view : views) {
    target->errors.push_back(Error(view, target->xyz));
    target->is_used.push_back(target->errors.back() <= max_error);
  }
}

size_t NumUsed(const TriangulatedTarget& target) {
  return static_cast<size_t>(std::count(target.is_used.begin(), target.is_used.end(), true));
}

// Of the meeting points of any two rays, the one with the smallest error in all views together.
std::optional<Eigen::Vector3d> BestMeeting(const std::vector<TargetView>& views, double max_error) {
  std::vector<std::optional<Ray>> rays;
  for (const TargetView& view : views) rays.push_back(RayOf(view));
  std::optional<Eigen::Vector3d> best;
  double best_cost = std::numeric_limits<double>::infinity();
  const size_t num_rays = std::min(views.size(), kMaxRays);
  const auto ray = [&](size_t k) { return rays[k * views.size() / num_rays]; };
  for (size_t i = 0; i < num_rays; ++i) {
    for (size_t j = i + 1; j < num_rays; ++j) {
      if (!ray(i) || !ray(j)) continue;
      const auto xyz = Meet(*ray(i), *ray(j));
      if (!xyz) continue;
      double cost = 0;
      for (const TargetView& view : views) cost += std::min(Error(view, *xyz), max_error);
      if (cost < best_cost) {
        best_cost = cost;
        best = xyz;
      }
    }
  }
  return best;
}

}  // namespace

TriangulatedTarget TriangulateTarget(const std::vector<TargetView>& views, double max_error) {
  TriangulatedTarget target;
  target.is_used.assign(views.size(), false);
  target.errors.assign(views.size(), std::numeric_limits<double>::infinity());
  if (views.size() < 2) {
    target.problem = "is marked in " + std::to_string(views.size()) +
                     " pictures of the model; 2 are needed at least";
    return target;
  }
  const auto start = BestMeeting(views, max_error);
  if (!start) {
    target.problem = "has no place: no two of its rays are half a degree apart and meet";
    return target;
  }
  target.xyz = *start;
  Judge(views, max_error, &target);
  for (int round = 0; round < kMaxRounds && NumUsed(target) >= 2; ++round) {
    const std::vector<bool> before = target.is_used;
    if (!Refine(views, &target)) break;
    Judge(views, max_error, &target);
    if (target.is_used == before) break;
  }
  const size_t num_used = NumUsed(target);
  if (num_used < 2 || 2 * num_used <= views.size()) {
    target.problem = "has no place that more than half of its " + std::to_string(views.size()) +
                     " marks agree on to " + std::to_string(max_error).substr(0, 4) + " pixels";
  }
  return target;
}

}  // namespace colmap_seapoint
