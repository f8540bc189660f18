// The area that a user asks for, in the plan of the map.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace colmap_seapoint {

using Ring = std::vector<Eigen::Vector2d>;  // closed: the last corner is joined to the first one

inline constexpr double kMaxAskedCells = 1e8;  // 2.4 GB of them

struct AskedArea {
  std::vector<Ring> rings;  // inside: within an odd number of them
  bool Empty() const { return rings.empty(); }
  bool Contains(const Eigen::Vector2d& place) const;
  // Whether it holds more cells of that side than the report can keep in memory.
  bool IsTooLarge(double cell_side) const;
};

// Whether two sides of the ring cross one another (neighbours touch, that is no crossing). O(n^2).
bool CrossesItself(const Ring& ring);
// Counter-clockwise is positive.
double SignedArea(const Ring& ring);

}  // namespace colmap_seapoint
