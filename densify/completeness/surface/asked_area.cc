#include "densify/completeness/surface/asked_area.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool SidesCross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                const Eigen::Vector2d& d) {
  const double c_side = Cross(b - a, c - a), d_side = Cross(b - a, d - a);
  const double a_side = Cross(d - c, a - c), b_side = Cross(d - c, b - c);
  return c_side * d_side < 0 && a_side * b_side < 0;
}

}  // namespace

bool AskedArea::Contains(const Eigen::Vector2d& place) const {
  bool is_inside = false;
  for (const Ring& ring : rings) {
    for (size_t i = 0, k = ring.size() - 1; i < ring.size(); k = i++) {
      const Eigen::Vector2d &a = ring[i], &b = ring[k];
      if ((a.y() > place.y()) == (b.y() > place.y())) continue;
      const double x = a.x() + (b.x() - a.x()) * (place.y() - a.y()) / (b.y() - a.y());
      if (place.x() < x) is_inside = !is_inside;
    }
  }
  return is_inside;
}

bool AskedArea::IsTooLarge(double cell_side) const {
  double area = 0, extent = 0;
  for (const Ring& ring : rings) {
    area += std::abs(SignedArea(ring));
    for (const Eigen::Vector2d& p : ring) extent = std::max(extent, p.cwiseAbs().maxCoeff());
  }
  // Cells are counted from the origin, in whole numbers.
  return area > kMaxAskedCells * cell_side * cell_side || extent > kMaxAskedCells * cell_side;
}

bool CrossesItself(const Ring& ring) {
  const size_t n = ring.size();
  for (size_t i = 0; i < n; ++i) {
    for (size_t k = i + 1; k < n; ++k) {
      if (SidesCross(ring[i], ring[(i + 1) % n], ring[k], ring[(k + 1) % n])) return true;
    }
  }
  return false;
}

double SignedArea(const Ring& ring) {
  double twice = 0;
  for (size_t i = 0; i < ring.size(); ++i) twice += Cross(ring[i], ring[(i + 1) % ring.size()]);
  return 0.5 * twice;
}

}  // namespace colmap_seapoint
