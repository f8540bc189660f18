#include "densify/completeness/surface/map_frame.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr double kRadPerDeg = 3.14159265358979323846 / 180;
const double kNearAxis = std::cos(20 * kRadPerDeg);
const double kInPlane = std::sin(20 * kRadPerDeg);
const double kTopCosine = std::cos(75 * kRadPerDeg);

struct Axes {
  Eigen::Vector3d longest, shortest, mean;
};

Axes AxesOf(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  return {solver.eigenvectors().col(2), solver.eigenvectors().col(0), mean};
}

MapFrame FrameOf(const Eigen::Vector3d& up, const Eigen::Vector3d& ahead_hint) {
  Eigen::Vector3d ahead = ahead_hint - up * up.dot(ahead_hint);
  ahead.normalize();
  MapFrame frame;
  frame.map_from_world << ahead.cross(up).transpose(), ahead.transpose(), up.transpose();
  return frame;
}

}  // namespace

MapFrame FitMapFrame(const std::vector<Eigen::Vector3d>& points,
                     const std::vector<Eigen::Vector3d>& camera_centers) {
  const Axes axes = AxesOf(points);
  Eigen::Vector3d up = axes.shortest;
  double towards_cameras = 0;
  for (const Eigen::Vector3d& center : camera_centers) {
    towards_cameras += up.dot(center - axes.mean);
  }
  if (towards_cameras < 0) up = -up;
  if (up.z() > kNearAxis) return {};
  if (std::abs(up.z()) < kInPlane) return FrameOf(up, Eigen::Vector3d::UnitZ());
  // Of the longest direction the one that runs to the side of the model's larger coordinates.
  Eigen::Index largest = 0;
  axes.longest.cwiseAbs().maxCoeff(&largest);
  const Eigen::Vector3d right = axes.longest * (axes.longest[largest] < 0 ? -1 : 1);
  return FrameOf(up, up.cross(right));
}

Eigen::Matrix3d SideFromMap(Side side) {
  const Eigen::RowVector3d u(1, 0, 0), v(0, 1, 0), w(0, 0, 1);
  Eigen::Matrix3d rows;
  switch (side) {
    case Side::kTop:
      rows << u, v, w;
      break;
    case Side::kRight:
      rows << v, w, u;
      break;
    case Side::kLeft:
      rows << w, v, -u;
      break;
    case Side::kAhead:
      rows << w, u, v;
      break;
    case Side::kBack:
      rows << u, w, -v;
      break;
    case Side::kUnder:
      rows << v, u, -w;
      break;
  }
  return rows;
}

Side SideOf(const Eigen::Vector3d& normal) {
  const double length = normal.norm();
  if (!(length > 0) || normal.z() >= kTopCosine * length) return Side::kTop;
  const double ax = std::abs(normal.x()), ay = std::abs(normal.y());
  if (-normal.z() > std::max(ax, ay)) return Side::kUnder;
  if (ax >= ay) return normal.x() > 0 ? Side::kRight : Side::kLeft;
  return normal.y() > 0 ? Side::kAhead : Side::kBack;
}

const char* SideName(Side side) {
  static constexpr const char* kNames[kNumSides] = {"top",   "right", "left",
                                                    "ahead", "back",  "under"};
  return kNames[static_cast<int>(side)];
}

}  // namespace colmap_seapoint
