#include "examples/survey/scene/height_field.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

// The ray in units of cells, relative to the first node.
struct LatticeRay {
  double x, y, z, dx, dy, dz;

  // The t at which the ray leaves the block of `size` cells with corner (bx, by) * size.
  double ExitT(int bx, int by, int size) const {
    double t = std::numeric_limits<double>::infinity();
    if (dx != 0) t = std::min(t, ((dx > 0 ? bx + 1 : bx) * double(size) - x) / dx);
    if (dy != 0) t = std::min(t, ((dy > 0 ? by + 1 : by) * double(size) - y) / dy);
    return t;
  }
};

// Smallest root in [a, b] of the parabola through f(a), f((a + b) / 2), f(b).
std::optional<double> FirstRoot(double a, double b, double fa, double fm, double fb) {
  if (fa <= 0) return a;
  const double curve = 2 * (fa - 2 * fm + fb), slope = fb - fa - curve;
  // fa + slope * s + curve * s^2, s in [0, 1]; the first root by the stable formula.
  const double discriminant = slope * slope - 4 * curve * fa;
  if (discriminant < 0) return std::nullopt;
  const double q = -slope + std::sqrt(discriminant);
  if (q <= 0) return std::nullopt;
  const double s = 2 * fa / q;
  if (s > 1) return std::nullopt;
  return a + s * (b - a);
}

double DistanceToEdge(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                      const Eigen::Vector3d& b) {
  const Eigen::Vector3d ab = b - a;
  const double t = std::clamp(ab.dot(p - a) / ab.squaredNorm(), 0.0, 1.0);
  return (a + t * ab - p).norm();
}

// Where the ray, inside cell (i, j) from t to t_exit, meets the bilinear patch.
std::optional<double> CellRoot(const HeightField& field, const LatticeRay& ray, int i, int j,
                               double t, double t_exit) {
  const double z00 = field.Node(i, j), z10 = field.Node(i + 1, j), z01 = field.Node(i, j + 1);
  const double z11 = field.Node(i + 1, j + 1);
  const auto clearance = [&](double s) {
    const double u = ray.x + s * ray.dx - i, v = ray.y + s * ray.dy - j;
    return ray.z + s * ray.dz -
           (z00 + u * (z10 - z00) + v * (z01 - z00) + u * v * (z00 - z10 - z01 + z11));
  };
  return FirstRoot(t, t_exit, clearance(t), clearance(0.5 * (t + t_exit)), clearance(t_exit));
}

// `local`: the point in units of cells, relative to the first node. The nearest point of the patch
// lies on an edge (a straight line: closed form) or where the gradient vanishes (Newton).
double DistanceToCell(const HeightField& field, const Eigen::Vector3d& local, int i, int j,
                      double best) {
  const double s = 1 / field.Grid().step;
  const double z00 = field.Node(i, j) * s, z10 = field.Node(i + 1, j) * s,
               z01 = field.Node(i, j + 1) * s;
  const double z11 = field.Node(i + 1, j + 1) * s;
  const Eigen::Vector3d p = local - Eigen::Vector3d(i, j, 0);
  const auto outside = [](double x, double low, double high) {
    return std::max({low - x, 0.0, x - high});
  };
  const Eigen::Vector3d gap(
      outside(p.x(), 0, 1), outside(p.y(), 0, 1),
      outside(p.z(), std::min({z00, z10, z01, z11}), std::max({z00, z10, z01, z11})));
  if (gap.squaredNorm() >= best * best) return best;

  best = std::min({best, DistanceToEdge(p, {0, 0, z00}, {1, 0, z10}),
                   DistanceToEdge(p, {0, 1, z01}, {1, 1, z11}),
                   DistanceToEdge(p, {0, 0, z00}, {0, 1, z01}),
                   DistanceToEdge(p, {1, 0, z10}, {1, 1, z11})});
  const double twist = z00 - z10 - z01 + z11;
  for (const auto& [start_u, start_v] : {std::pair(0.2, 0.2), {0.8, 0.2}, {0.2, 0.8}, {0.8, 0.8}}) {
    double u = start_u, v = start_v;
    for (int iteration = 0; iteration < 12; ++iteration) {
      const double zu = z10 - z00 + v * twist, zv = z01 - z00 + u * twist;
      const Eigen::Vector3d e(u - p.x(), v - p.y(),
                              z00 + u * (z10 - z00) + v * (z01 - z00) + u * v * twist - p.z());
      best = std::min(best, e.norm());
      const double gu = e.x() + e.z() * zu, gv = e.y() + e.z() * zv;
      const double a = 1 + zu * zu, c = 1 + zv * zv;
      double b = zu * zv + e.z() * twist;
      if (a * c - b * b <= 1e-3 * a * c) b = zu * zv;  // no minimum near: Gauss-Newton
      const double det = a * c - b * b;
      const double next_u = std::clamp(u - (c * gu - b * gv) / det, 0.0, 1.0);
      const double next_v = std::clamp(v - (a * gv - b * gu) / det, 0.0, 1.0);
      if (std::abs(next_u - u) + std::abs(next_v - v) < 1e-9) break;
      u = next_u;
      v = next_v;
    }
  }
  return best;
}

HeightBlocks MakeBlocks(const HeightField& field, int size) {
  const GridSpec& grid = field.Grid();
  const int cells_x = grid.nx - 1, cells_y = grid.ny - 1;
  HeightBlocks blocks;
  blocks.size = size;
  blocks.nx = (cells_x + size - 1) / size;
  const int ny = (cells_y + size - 1) / size;
  blocks.max.assign(static_cast<size_t>(blocks.nx) * static_cast<size_t>(ny), field.MinHeight());
  for (int j = 0; j < grid.ny; ++j) {
    for (int i = 0; i < grid.nx; ++i) {
      // A node on the border of blocks belongs to all of them.
      for (int by = std::max(0, (j - 1) / size); by <= std::min(ny - 1, j / size); ++by) {
        for (int bx = std::max(0, (i - 1) / size); bx <= std::min(blocks.nx - 1, i / size); ++bx) {
          float& max = blocks.max[static_cast<size_t>(by * blocks.nx + bx)];
          max = std::max(max, field.Node(i, j));
        }
      }
    }
  }
  return blocks;
}

}  // namespace

HeightField::HeightField(const GridSpec& grid, Field heights)
    : grid_(grid), heights_(std::move(heights)) {
  SEAPOINT_CHECK(grid.nx >= 2 && grid.ny >= 2 && heights_.size() == grid.Size());
  const auto range = std::minmax_element(heights_.begin(), heights_.end());
  min_height_ = *range.first;
  max_height_ = *range.second;
  for (int size : {4, 16, 64}) levels_.push_back(MakeBlocks(*this, size));
}

double HeightField::Height(double x, double y) const {
  const double gx = std::clamp(x / grid_.step - static_cast<double>(grid_.ix0), 0.0,
                               static_cast<double>(grid_.nx - 1));
  const double gy = std::clamp(y / grid_.step - static_cast<double>(grid_.iy0), 0.0,
                               static_cast<double>(grid_.ny - 1));
  const int i = std::min(static_cast<int>(gx), grid_.nx - 2);
  const int j = std::min(static_cast<int>(gy), grid_.ny - 2);
  const double u = gx - i, v = gy - j;
  const double top = Node(i, j) + u * (Node(i + 1, j) - Node(i, j));
  const double bottom = Node(i, j + 1) + u * (Node(i + 1, j + 1) - Node(i, j + 1));
  return top + v * (bottom - top);
}

Eigen::Vector3d HeightField::Normal(double x, double y) const {
  const double h = grid_.step;
  return Eigen::Vector3d(Height(x - h, y) - Height(x + h, y), Height(x, y - h) - Height(x, y + h),
                         2 * h)
      .normalized();
}

std::optional<double> HeightField::IntersectRay(const Eigen::Vector3d& origin,
                                                const Eigen::Vector3d& direction, double t_min,
                                                double t_max) const {
  const double per_cell = 1 / grid_.step;
  const LatticeRay ray{origin.x() * per_cell - static_cast<double>(grid_.ix0),
                       origin.y() * per_cell - static_cast<double>(grid_.iy0),
                       origin.z(),
                       direction.x() * per_cell,
                       direction.y() * per_cell,
                       direction.z()};
  double t = t_min;
  if (ray.dz < 0) t = std::max(t, (max_height_ - ray.z) / ray.dz);
  if (ray.dz > 0) t_max = std::min(t_max, (max_height_ - ray.z) / ray.dz);
  // Stepping over a border by a billionth of a cell: no block is met twice, nothing is missed.
  const double nudge = 1e-9 / std::max({std::abs(ray.dx), std::abs(ray.dy), 1e-12});
  int level = static_cast<int>(levels_.size());  // 0 = single cells
  while (t <= t_max) {
    const int size = level == 0 ? 1 : levels_[static_cast<size_t>(level - 1)].size;
    const double x = ray.x + (t + nudge) * ray.dx, y = ray.y + (t + nudge) * ray.dy;
    if (x < 0 || y < 0 || x >= grid_.nx - 1 || y >= grid_.ny - 1) {
      if (level == 0 || !(std::isfinite(x) && std::isfinite(y))) return std::nullopt;
      const bool leaving = (x < 0 && ray.dx <= 0) || (y < 0 && ray.dy <= 0) ||
                           (x >= grid_.nx - 1 && ray.dx >= 0) || (y >= grid_.ny - 1 && ray.dy >= 0);
      if (leaving) return std::nullopt;
      t += 1 / std::max(std::abs(ray.dx), std::abs(ray.dy));  // still on the way in
      continue;
    }
    const int bx = static_cast<int>(x) / size, by = static_cast<int>(y) / size;
    const double t_exit = std::min(std::max(ray.ExitT(bx, by, size), t), t_max);
    if (level > 0) {
      const HeightBlocks& blocks = levels_[static_cast<size_t>(level - 1)];
      const double lowest = ray.z + ray.dz * (ray.dz < 0 ? t_exit : t);
      if (lowest <= blocks.max[static_cast<size_t>(by * blocks.nx + bx)]) {
        --level;
        continue;
      }
    } else {
      const auto root = CellRoot(*this, ray, bx, by, t, t_exit);
      if (root) return root;
    }
    if (t_exit >= t_max) return std::nullopt;
    t = t_exit + nudge;
    level = std::min(level + 1, static_cast<int>(levels_.size()));
  }
  return std::nullopt;
}

double HeightField::Distance(const Eigen::Vector3d& point, double limit) const {
  const Eigen::Vector3d local(point.x() / grid_.step - static_cast<double>(grid_.ix0),
                              point.y() / grid_.step - static_cast<double>(grid_.iy0),
                              point.z() / grid_.step);
  double best = limit / grid_.step;
  if (grid_.Contains(point.x(), point.y())) {
    best = std::min(best, std::abs(point.z() - Height(point.x(), point.y())) / grid_.step);
  }
  const double far = best + 1;
  if (local.x() < -far || local.y() < -far || local.x() > grid_.nx + far ||
      local.y() > grid_.ny + far) {
    return limit;
  }
  const int ci = static_cast<int>(std::floor(local.x()));
  const int cj = static_cast<int>(std::floor(local.y()));
  for (int ring = 0; ring - 1 < best; ++ring) {
    for (int j = cj - ring; j <= cj + ring; ++j) {
      const bool whole_row = std::abs(j - cj) == ring;
      for (int i = ci - ring; i <= ci + ring; i += whole_row || ring == 0 ? 1 : 2 * ring) {
        if (i < 0 || j < 0 || i >= grid_.nx - 1 || j >= grid_.ny - 1) continue;
        best = DistanceToCell(*this, local, i, j, best);
      }
    }
  }
  return std::min(limit, best * grid_.step);
}

}  // namespace colmap_seapoint
