// An exact surface that no height field can hold (overhangs, a closed shape): a lattice of nodes in
// space, two flat triangles in every cell. As with the height field, that is the definition of the
// truth, not an approximation.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace colmap_seapoint {

class Sheet {
 public:
  Sheet() = default;
  // `nodes`: nx * ny places, row by row, metres; `step`: metres between neighbours on the sheet's
  // own map of colours. Seen from outside, i runs to the right where j runs upwards.
  Sheet(int nx, int ny, std::vector<Eigen::Vector3f> nodes, double step);

  bool Empty() const { return nodes_.empty(); }
  int NumX() const { return nx_; }
  int NumY() const { return ny_; }
  double Step() const { return step_; }
  const std::vector<Eigen::Vector3f>& Nodes() const { return nodes_; }

  struct Hit {
    double t = 0;
    Eigen::Vector2d lattice;  // (i, j) of the place, with fractions
  };
  // The first t in [t_min, t_max] where origin + t * direction meets the sheet, from either side.
  std::optional<Hit> IntersectRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double t_min, double t_max) const;

  // Distance from the point to the nearest point of the sheet; exact below `limit`, else `limit`.
  double Distance(const Eigen::Vector3d& point, double limit) const;

  // On the triangles.
  Eigen::Vector3d At(const Eigen::Vector2d& lattice) const;
  // Unit normal (outwards), smooth across the cells.
  Eigen::Vector3d Normal(const Eigen::Vector2d& lattice) const;

 private:
  struct Box {
    Eigen::Array3f min, max;
  };
  struct Level {  // boxes around blocks of `size` x `size` cells
    int size, nx, ny;
    std::vector<Box> boxes;
  };
  template <typename Visitor>
  void Visit(size_t level, int bx, int by, Visitor* visitor) const;

  int nx_ = 0, ny_ = 0;
  double step_ = 0;
  std::vector<Eigen::Vector3f> nodes_;
  std::vector<Level> levels_;  // fine to coarse; the last one is one box
};

}  // namespace colmap_seapoint
