// SeaPoints as nanoflann wants them: nearest neighbours in the picture plane.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <nanoflann.hpp>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {

struct SeaPointPositions {
  std::vector<SeaPoint> points;

  size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(size_t i, size_t dim) const { return dim == 0 ? points[i].x : points[i].y; }
  template <typename BoundingBox>
  bool kdtree_get_bbox(BoundingBox&) const {
    return false;
  }
};

// Deterministic: equal distances come in the order of the tree, which the points alone decide.
class SeaPointTree {
 public:
  explicit SeaPointTree(std::vector<SeaPoint> points)
      : positions_{std::move(points)},
        tree_(2, positions_, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {
    tree_.buildIndex();
  }
  SeaPointTree(const SeaPointTree&) = delete;
  SeaPointTree& operator=(const SeaPointTree&) = delete;

  // Indices of the (up to) `count` nearest points, nearest first. `indices` is scratch and result.
  size_t Nearest(float x, float y, size_t count, std::vector<uint32_t>* indices) {
    indices->resize(count);
    squared_distances_.resize(count);
    const float query[2] = {x, y};
    const size_t found = tree_.knnSearch(query, count, indices->data(), squared_distances_.data());
    indices->resize(found);
    return found;
  }

  // Indices of all points within `radius`, ascending.
  void Within(float x, float y, float radius, std::vector<uint32_t>* indices) {
    const float query[2] = {x, y};
    nanoflann::SearchParams params;
    params.sorted = false;
    found_.clear();
    tree_.radiusSearch(query, radius * radius, found_, params);
    indices->clear();
    for (const auto& [index, squared_distance] : found_) indices->push_back(index);
    std::sort(indices->begin(), indices->end());
  }

 private:
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, SeaPointPositions>,
                                          SeaPointPositions, 2>;
  const SeaPointPositions positions_;
  Tree tree_;
  std::vector<float> squared_distances_;
  std::vector<std::pair<uint32_t, float>> found_;
};

}  // namespace colmap_seapoint
