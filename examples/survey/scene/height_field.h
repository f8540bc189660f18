// The exact surface: heights on a regular lattice, bilinear between the nodes. That is not an
// approximation of the truth but its definition: pictures are ray-cast from it, clouds are scored
// against it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "examples/survey/scene/noise.h"

namespace colmap_seapoint {

// The largest height in every block of `size` x `size` cells: a ray above it skips the block.
struct HeightBlocks {
  int size = 1;
  int nx = 0;
  std::vector<float> max;
};

class HeightField {
 public:
  HeightField() = default;
  // `heights`: one a node of `grid`, world z, metres.
  HeightField(const GridSpec& grid, Field heights);

  const GridSpec& Grid() const { return grid_; }
  const Field& Heights() const { return heights_; }
  float MinHeight() const { return min_height_; }
  float MaxHeight() const { return max_height_; }
  float Node(int i, int j) const {
    return heights_[static_cast<size_t>(j) * static_cast<size_t>(grid_.nx) +
                    static_cast<size_t>(i)];
  }

  // Outside the field: the height of the nearest place on its edge.
  double Height(double x, double y) const;
  // Unit normal (upwards), from central differences: smooth across the cells.
  Eigen::Vector3d Normal(double x, double y) const;

  // The first t in [t_min, t_max] where origin + t * direction meets the surface. Exact.
  std::optional<double> IntersectRay(const Eigen::Vector3d& origin,
                                     const Eigen::Vector3d& direction, double t_min,
                                     double t_max) const;

  // Distance from the point to the nearest point of the surface; exact below `limit` (metres),
  // else `limit`. Cost grows with the square of the distance in cells.
  double Distance(const Eigen::Vector3d& point, double limit) const;

 private:
  GridSpec grid_;
  Field heights_;
  float min_height_ = 0;
  float max_height_ = 0;
  std::vector<HeightBlocks> levels_;  // fine to coarse
};

}  // namespace colmap_seapoint
