#include "examples/survey/scene/sheet.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr int kFan = 4;  // blocks along each side of the block above

// The corners of triangle `upper` of a cell, relative to the cell, and the place of barycentric
// weights (b1, b2) of the second and third corner.
constexpr int kCorners[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};

Eigen::Vector2d LatticePlace(int upper, int i, int j, double b1, double b2) {
  return upper == 0 ? Eigen::Vector2d(i + b1 + b2, j + b2) : Eigen::Vector2d(i + b1, j + b1 + b2);
}

// The point of the triangle a, a + ab, a + ac that lies nearest to p (Ericson, Real-Time Collision
// Detection 5.1.5), as a squared distance.
double SquaredDistance(const Eigen::Vector3d& p, const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d &a = corners[0], &b = corners[1], &c = corners[2];
  const auto to_edge = [&p](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d way = to - from;
    const double t = std::clamp(way.dot(p - from) / std::max(way.squaredNorm(), 1e-30), 0.0, 1.0);
    return (from + t * way - p).squaredNorm();
  };
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area = normal.squaredNorm();
  const bool inside = area > 0 && normal.dot((b - a).cross(p - a)) >= 0 &&
                      normal.dot((c - b).cross(p - b)) >= 0 &&
                      normal.dot((a - c).cross(p - c)) >= 0;
  if (inside) return std::pow(normal.dot(p - a), 2) / area;
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

// Finds the first triangle on a ray.
struct RayVisitor {
  Eigen::Vector3d origin, direction;
  Eigen::Array3d inverse;
  double t_min, t_max;
  std::optional<Sheet::Hit> hit;

  bool Enters(const Eigen::Array3d& low, const Eigen::Array3d& high) const {
    const Eigen::Array3d a = (low - origin.array()) * inverse;
    const Eigen::Array3d b = (high - origin.array()) * inverse;
    const double entry = a.min(b).maxCoeff(), exit = a.max(b).minCoeff();
    // A flat box, or one that the ray only touches, must not be lost to rounding.
    const double slack = 1e-9 * (1 + std::abs(exit));
    return entry <= exit + slack && exit >= t_min - slack && entry <= t_max + slack;
  }

  void Triangle(const std::array<Eigen::Vector3d, 3>& corners, int upper, int i, int j) {
    const Eigen::Vector3d ab = corners[1] - corners[0], ac = corners[2] - corners[0];
    const Eigen::Vector3d p = direction.cross(ac);
    const double determinant = ab.dot(p);
    if (determinant == 0) return;
    constexpr double kSlack = 1e-10;  // neighbours overlap by it: no ray slips between them
    const Eigen::Vector3d from = origin - corners[0];
    const double b1 = from.dot(p) / determinant;
    if (!(b1 >= -kSlack && b1 <= 1 + kSlack)) return;
    const Eigen::Vector3d q = from.cross(ab);
    const double b2 = direction.dot(q) / determinant;
    if (!(b2 >= -kSlack && b1 + b2 <= 1 + kSlack)) return;
    const double t = ac.dot(q) / determinant;
    if (!(t >= t_min && t <= t_max)) return;
    t_max = t;
    hit = Sheet::Hit{t, LatticePlace(upper, i, j, b1, b2)};
  }
};

struct DistanceVisitor {
  Eigen::Vector3d point;
  double best;  // squared

  bool Enters(const Eigen::Array3d& low, const Eigen::Array3d& high) const {
    const Eigen::Array3d gap = (low - point.array()).max(point.array() - high).max(0);
    return gap.matrix().squaredNorm() < best;
  }
  void Triangle(const std::array<Eigen::Vector3d, 3>& corners, int, int, int) {
    best = std::min(best, SquaredDistance(point, corners));
  }
};

}  // namespace

Sheet::Sheet(int nx, int ny, std::vector<Eigen::Vector3f> nodes, double step)
    : nx_(nx), ny_(ny), step_(step), nodes_(std::move(nodes)) {
  SEAPOINT_CHECK(nx >= 2 && ny >= 2 &&
                 nodes_.size() == static_cast<size_t>(nx) * static_cast<size_t>(ny));
  const float inf = std::numeric_limits<float>::infinity();
  for (int size = kFan;; size *= kFan) {
    Level level{size, (nx - 2) / size + 1, (ny - 2) / size + 1, {}};
    for (int by = 0; by < level.ny; ++by) {
      for (int bx = 0; bx < level.nx; ++bx) {
        Box box{Eigen::Array3f::Constant(inf), Eigen::Array3f::Constant(-inf)};
        for (int j = by * size; j <= std::min(ny - 1, (by + 1) * size); ++j) {
          for (int i = bx * size; i <= std::min(nx - 1, (bx + 1) * size); ++i) {
            const Eigen::Array3f node =
                nodes_[static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i)]
                    .array();
            box.min = box.min.min(node);
            box.max = box.max.max(node);
          }
        }
        level.boxes.push_back(box);
      }
    }
    const bool whole = level.nx == 1 && level.ny == 1;
    levels_.push_back(std::move(level));
    if (whole) break;
  }
}

// Hands the visitor every triangle of block (bx, by) whose boxes it enters. `level` counts from 1;
// 0 is a single cell.
template <typename Visitor>
void Sheet::Visit(size_t level, int bx, int by, Visitor* visitor) const {
  if (level == 0) {
    for (int upper = 0; upper < 2; ++upper) {
      std::array<Eigen::Vector3d, 3> corners;
      for (size_t k = 0; k < 3; ++k) {
        const int i = bx + kCorners[upper][k][0], j = by + kCorners[upper][k][1];
        corners[k] =
            nodes_[static_cast<size_t>(j) * static_cast<size_t>(nx_) + static_cast<size_t>(i)]
                .cast<double>();
      }
      visitor->Triangle(corners, upper, bx, by);
    }
    return;
  }
  const Level& blocks = levels_[level - 1];
  const Box& box = blocks.boxes[static_cast<size_t>(by * blocks.nx + bx)];
  if (!visitor->Enters(box.min.cast<double>(), box.max.cast<double>())) return;
  const int end_x = level == 1 ? nx_ - 1 : levels_[level - 2].nx;
  const int end_y = level == 1 ? ny_ - 1 : levels_[level - 2].ny;
  for (int y = by * kFan; y < std::min(end_y, (by + 1) * kFan); ++y) {
    for (int x = bx * kFan; x < std::min(end_x, (bx + 1) * kFan); ++x) {
      Visit(level - 1, x, y, visitor);
    }
  }
}

std::optional<Sheet::Hit> Sheet::IntersectRay(const Eigen::Vector3d& origin,
                                              const Eigen::Vector3d& direction, double t_min,
                                              double t_max) const {
  if (Empty()) return std::nullopt;
  const Eigen::Array3d way = direction.array();
  const Eigen::Array3d inverse = (way == 0).select(Eigen::Array3d::Constant(1e300), way.inverse());
  RayVisitor visitor{origin, direction, inverse, t_min, t_max, {}};
  Visit(levels_.size(), 0, 0, &visitor);
  return visitor.hit;
}

double Sheet::Distance(const Eigen::Vector3d& point, double limit) const {
  if (Empty()) return limit;
  // Most points lie close to the sheet: a search that begins with a narrow reach enters few blocks.
  for (double reach = std::min(2 * step_, limit);; reach = std::min(4 * reach, limit)) {
    DistanceVisitor visitor{point, reach * reach};
    Visit(levels_.size(), 0, 0, &visitor);
    if (visitor.best < reach * reach) return std::sqrt(visitor.best);
    if (reach >= limit) return limit;
  }
}

Eigen::Vector3d Sheet::At(const Eigen::Vector2d& lattice) const {
  const int i = std::clamp(static_cast<int>(lattice.x()), 0, nx_ - 2);
  const int j = std::clamp(static_cast<int>(lattice.y()), 0, ny_ - 2);
  const double u = lattice.x() - i, v = lattice.y() - j;
  const int upper = v > u;
  const auto corner = [&](int k) -> Eigen::Vector3d {
    return nodes_[static_cast<size_t>(j + kCorners[upper][k][1]) * static_cast<size_t>(nx_) +
                  static_cast<size_t>(i + kCorners[upper][k][0])]
        .cast<double>();
  };
  const double b1 = upper == 0 ? u - v : u, b2 = upper == 0 ? v : v - u;
  return (1 - b1 - b2) * corner(0) + b1 * corner(1) + b2 * corner(2);
}

Eigen::Vector3d Sheet::Normal(const Eigen::Vector2d& lattice) const {
  const auto at = [&](double di, double dj) {
    return At({std::clamp(lattice.x() + di, 0.0, nx_ - 1.0),
               std::clamp(lattice.y() + dj, 0.0, ny_ - 1.0)});
  };
  return (at(1, 0) - at(-1, 0)).cross(at(0, 1) - at(0, -1)).normalized();
}

}  // namespace colmap_seapoint
