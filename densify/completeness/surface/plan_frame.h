// The plan that a survey is drawn on, and the six sides that its surface is looked at from.
#pragma once

#include <Eigen/Core>

namespace colmap_seapoint {

// The plan that the survey is drawn on. Rows: right, ahead, up; right-handed, orthonormal. Same
// origin and unit as the world.
struct PlanFrame {
  Eigen::Matrix3d map_from_world = Eigen::Matrix3d::Identity();
  // Whether it is the world itself: its z points up.
  bool IsWorld() const { return map_from_world.isIdentity(0); }
};

// A box unfolded: a wall is looked at from its side, so that it does not vanish in the plan.
enum class Side { kTop, kRight, kLeft, kAhead, kBack, kUnder };
inline constexpr int kNumSides = 6;

// Rows: u, v of that side's plan, and w towards the viewer; right-handed. kTop: the map's own.
Eigen::Matrix3d SideFromMap(Side side);
// By the normal in the map's frame: kTop up to 75 degrees from upwards, and for a point without
// normal; else the nearest one of the others.
Side SideOf(const Eigen::Vector3d& normal);
const char* SideName(Side side);  // "top", "right", ...

}  // namespace colmap_seapoint
