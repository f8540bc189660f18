#include "colmap_seapoint/compare/tile_partition.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace colmap_seapoint {

TilePartition::TilePartition(std::vector<Eigen::Array2d> sample, double points_per_sample,
                             double max_points) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kRelativeSlack = 1e-9;
  for (const Eigen::Array2d& place : sample) {
    slack_ = std::max(slack_, kRelativeSlack * place.abs().maxCoeff());
  }
  Split(sample.begin(), sample.end(), max_points / points_per_sample,
        {Eigen::Array2d::Constant(-kInfinity), Eigen::Array2d::Constant(kInfinity)});
}

int TilePartition::Split(std::vector<Eigen::Array2d>::iterator begin,
                         std::vector<Eigen::Array2d>::iterator end, double max_samples,
                         const PlanBox& box) {
  const int node = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Eigen::Array2d low = box.high, high = box.low;
  for (auto place = begin; place != end; ++place) {
    low = low.min(*place);
    high = high.max(*place);
  }
  const int axis = high[1] - low[1] > high[0] - low[0] ? 1 : 0;
  const bool is_tile = static_cast<double>(end - begin) <= max_samples || !(low[axis] < high[axis]);
  if (is_tile) {
    nodes_.back().below = NumTiles();
    boxes_.push_back(box);
    return node;
  }
  const auto middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end, [axis](const Eigen::Array2d& a, const Eigen::Array2d& b) {
    return a[axis] < b[axis];
  });
  double split = (*middle)[axis];
  // Where many places have one value, the part below the split must still not be empty.
  if (split == low[axis]) split = std::nextafter(split, high[axis]);
  const auto cut = std::partition(
      begin, end, [axis, split](const Eigen::Array2d& place) { return place[axis] < split; });
  PlanBox below = box, above = box;
  below.high[axis] = above.low[axis] = split;
  const int below_node = Split(begin, cut, max_samples, below);
  const int above_node = Split(cut, end, max_samples, above);
  nodes_[static_cast<size_t>(node)] = {axis, split, below_node, above_node};
  return node;
}

int TilePartition::TileOf(const Eigen::Array2d& place) const {
  const Node* node = &nodes_.front();
  while (node->axis >= 0) {
    const int next = place[node->axis] < node->split ? node->below : node->above;
    node = &nodes_[static_cast<size_t>(next)];
  }
  return node->below;
}

std::vector<int> TilePartition::Neighbours(int tile, double reach) const {
  const PlanBox& box = Box(tile);
  std::vector<std::pair<double, int>> found;
  for (int other = 0; other < NumTiles(); ++other) {
    if (other == tile) continue;
    const PlanBox& o = Box(other);
    const double distance = (o.low - box.high).max(box.low - o.high).max(0.0).matrix().norm();
    if (distance <= reach + slack_) found.emplace_back(distance, other);
  }
  std::sort(found.begin(), found.end());
  std::vector<int> tiles;
  for (const auto& entry : found) tiles.push_back(entry.second);
  return tiles;
}

}  // namespace colmap_seapoint
