// The plan cut into rectangles that hold about as many points each.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace colmap_seapoint {

struct PlanBox {
  Eigen::Array2d low, high;  // the outermost ones reach to infinity

  bool Contains(const Eigen::Array2d& place) const {
    return (place >= low).all() && (place < high).all();
  }
  // Distance to the nearest place of the box; 0 inside.
  double Distance(const Eigen::Array2d& place) const {
    return (low - place).max(place - high).max(0.0).matrix().norm();
  }
};

class TilePartition {
 public:
  // Halves the sample (right and down of PlanView) along its longer side until a tile stands for
  // `max_points` points or fewer, each sample for `points_per_sample`. Points that share one place
  // of the plan cannot be parted. The order of the sample does not matter.
  TilePartition(std::vector<Eigen::Array2d> sample, double points_per_sample, double max_points);

  int NumTiles() const { return static_cast<int>(boxes_.size()); }
  int TileOf(const Eigen::Array2d& place) const;
  const PlanBox& Box(int tile) const { return boxes_[static_cast<size_t>(tile)]; }
  // Other tiles that come within `reach` of this one, the nearest first.
  std::vector<int> Neighbours(int tile, double reach) const;
  // More than what rounding does to a place.
  double Slack() const { return slack_; }

 private:
  struct Node {
    int axis = -1;  // -1: a tile
    double split = 0;
    int below = 0, above = 0;  // nodes; the tile's number in `below`
  };

  int Split(std::vector<Eigen::Array2d>::iterator begin, std::vector<Eigen::Array2d>::iterator end,
            double max_samples, const PlanBox& box);

  std::vector<Node> nodes_;
  std::vector<PlanBox> boxes_;
  double slack_ = 0;
};

}  // namespace colmap_seapoint
