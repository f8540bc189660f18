#include "colmap_seapoint/compare/point_index.h"

#include <cstdint>
#include <nanoflann.hpp>

namespace colmap_seapoint {
namespace {

// The nearest point so far, in the form that nanoflann asks for.
struct NearestResult {
  double best;
  bool skip_zero;

  double worstDist() const { return best; }
  bool full() const { return true; }
  size_t size() const { return 1; }
  // Called for the points of a leaf, some of which may be farther than the best one by now. False
  // ends the search: nothing is nearer than 0.
  bool addPoint(double squared, uint32_t) {
    if (squared >= best || (skip_zero && squared == 0)) return true;
    best = squared;
    return best > 0;
  }
};

}  // namespace

struct PointIndex::Tree {
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Tree>,
                                                    Tree, 3, uint32_t>;

  explicit Tree(const PointVector& p)
      : points(p), index(3, *this, nanoflann::KDTreeSingleIndexAdaptorParams(12)) {
    index.buildIndex();
  }
  size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(size_t i, size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

  const PointVector& points;
  Index index;
};

PointIndex::PointIndex(const PointVector& points) {
  if (!points.empty()) tree_ = std::make_unique<Tree>(points);
}

PointIndex::~PointIndex() = default;

void PointIndex::Nearest(const Eigen::Vector3d& place, NearestOf what, double* squared) const {
  if (!tree_ || *squared == 0) return;
  NearestResult result{*squared, what == NearestOf::kOtherPlace};
  tree_->index.findNeighbors(result, place.data(), nanoflann::SearchParams());
  *squared = result.best;
}

}  // namespace colmap_seapoint
