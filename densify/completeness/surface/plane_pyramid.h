// Heights over a plan where they are known, and planes through them where they are not: a gap has
// to be drawn somewhere. Nothing of it is ever counted as covered.
#pragma once

#include <Eigen/Core>
#include <array>
#include <unordered_map>
#include <vector>

#include "densify/completeness/surface/tiled_grid.h"

namespace colmap_seapoint {

// Sums over points (u, v, h) with weights.
struct PlaneMoments {
  double n = 0, u = 0, v = 0, h = 0, uu = 0, uv = 0, vv = 0, uh = 0, vh = 0;

  void Add(double pu, double pv, double ph, double weight);
  void Add(const PlaneMoments& other);
};

struct PlaneAt {
  double height = 0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  // dh/du, dh/dv
  Eigen::Vector3d Normal() const { return {-slope.x(), -slope.y(), 1}; }
};

class PlanePyramid {
 public:
  // `side`: of the finest cells, units.
  explicit PlanePyramid(double side) : side_(side) {}
  void Add(double u, double v, double h, double weight);
  // Sums up the coarser levels. To be called once, after the last Add().
  void Finish();

  // The plane through the nearest surroundings that are known on all sides, at the finest level
  // that has such. Where nothing is known on all sides, outside, what lies nearest goes on with the
  // slope of the whole: that of its rim is chance.
  // About a microsecond; from any number of threads.
  PlaneAt At(double u, double v) const;

 private:
  using Level = std::unordered_map<TileKey, PlaneMoments, TileKeyHash>;
  static constexpr int kNumLevels = 12;

  double side_;
  Eigen::Vector2d trend_ = Eigen::Vector2d::Zero();  // slope of the whole
  std::array<Level, kNumLevels> levels_;
};

}  // namespace colmap_seapoint
