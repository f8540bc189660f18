#include "densify/completeness/surface/plane_pyramid.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace colmap_seapoint {
namespace {

constexpr size_t kTrendLevel = 4;  // cells whose slopes' median is the slope of the whole
// Steeper planes come from noise, or belong to another chart.
constexpr double kMaxSlope = 3;

TileKey KeyAt(double u, double v, double side) {
  return {static_cast<int>(std::floor(u / side)), static_cast<int>(std::floor(v / side))};
}

PlaneAt FitPlane(const PlaneMoments& m, double u, double v, double side) {
  const double mu = m.u / m.n, mv = m.v / m.n, mh = m.h / m.n;
  // Where hardly anything tells the slope, it is level.
  const double rest = 1e-3 * side * side;
  Eigen::Matrix2d a;
  a << m.uu / m.n - mu * mu + rest, m.uv / m.n - mu * mv, 0, m.vv / m.n - mv * mv + rest;
  a(1, 0) = a(0, 1);
  const Eigen::Vector2d b(m.uh / m.n - mu * mh, m.vh / m.n - mv * mh);
  PlaneAt plane;
  plane.slope = a.ldlt().solve(b);
  if (!plane.slope.allFinite()) plane.slope.setZero();
  const double steepness = plane.slope.norm();
  if (steepness > kMaxSlope) plane.slope *= kMaxSlope / steepness;
  // Not extrapolated farther than the cells reach.
  const Eigen::Vector2d aside(std::clamp(u - mu, -1.5 * side, 1.5 * side),
                              std::clamp(v - mv, -1.5 * side, 1.5 * side));
  plane.height = mh + plane.slope.dot(aside);
  return plane;
}

// Of values with weights; the order in which they come is all the same.
double WeightedMedian(std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  double total = 0, below = 0;
  for (const auto& [value, weight] : values) total += weight;
  for (const auto& [value, weight] : values) {
    below += weight;
    if (2 * below >= total) return value;
  }
  return 0;
}

}  // namespace

void PlaneMoments::Add(double pu, double pv, double ph, double weight) {
  n += weight;
  u += weight * pu;
  v += weight * pv;
  h += weight * ph;
  uu += weight * pu * pu;
  uv += weight * pu * pv;
  vv += weight * pv * pv;
  uh += weight * pu * ph;
  vh += weight * pv * ph;
}

void PlaneMoments::Add(const PlaneMoments& other) {
  n += other.n;
  u += other.u;
  v += other.v;
  h += other.h;
  uu += other.uu;
  uv += other.uv;
  vv += other.vv;
  uh += other.uh;
  vh += other.vh;
}

void PlanePyramid::Add(double u, double v, double h, double weight) {
  levels_[0][KeyAt(u, v, side_)].Add(u, v, h, weight);
}

void PlanePyramid::Finish() {
  for (size_t level = 1; level < levels_.size(); ++level) {
    // In one order, so that sums are the same whatever the order of insertion.
    std::vector<TileKey> keys;
    for (const auto& entry : levels_[level - 1]) keys.push_back(entry.first);
    std::sort(keys.begin(), keys.end());
    for (const TileKey& key : keys) {
      levels_[level][{key.x >> 1, key.y >> 1}].Add(levels_[level - 1].at(key));
    }
  }
  std::vector<std::pair<double, double>> slopes[2];  // with weights
  const double side = side_ * (1 << kTrendLevel);
  for (const auto& [key, moments] : levels_[kTrendLevel]) {
    const Eigen::Vector2d slope = FitPlane(moments, 0, 0, side).slope;
    for (int axis = 0; axis < 2; ++axis) slopes[axis].emplace_back(slope[axis], moments.n);
  }
  trend_ = {WeightedMedian(std::move(slopes[0])), WeightedMedian(std::move(slopes[1]))};
}

PlaneAt PlanePyramid::At(double u, double v) const {
  double side = side_;
  PlaneMoments nearest;
  for (const Level& level : levels_) {
    const TileKey center = KeyAt(u, v, side);
    PlaneMoments sum;
    std::array<bool, 3> has_column = {}, has_row = {};
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto place = level.find({center.x + dx, center.y + dy});
        if (place == level.end()) continue;
        has_column[static_cast<size_t>(dx + 1)] = has_row[static_cast<size_t>(dy + 1)] = true;
        sum.Add(place->second);
      }
    }
    if (has_column[0] && has_column[2] && has_row[0] && has_row[2]) {
      return FitPlane(sum, u, v, side);
    }
    if (nearest.n == 0) nearest = sum;
    side *= 2;
  }
  PlaneAt plane;
  if (nearest.n == 0) return plane;
  plane.slope = trend_;
  plane.height = nearest.h / nearest.n + trend_.x() * (u - nearest.u / nearest.n) +
                 trend_.y() * (v - nearest.v / nearest.n);
  return plane;
}

}  // namespace colmap_seapoint
