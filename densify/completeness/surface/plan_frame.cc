#include "densify/completeness/surface/plan_frame.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr double kRadPerDeg = 3.14159265358979323846 / 180;
const double kTopCosine = std::cos(75 * kRadPerDeg);

}  // namespace

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
