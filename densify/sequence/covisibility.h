// What two pictures of a model share, by its triangulated points (ours).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "densify/match/view.h"

namespace colmap_seapoint {

// For every position, the positions that share triangulated points with it, most shared first, ties
// by position; at most 12. O(track elements squared per point).
std::vector<std::vector<int>> CovisiblePictures(const SparseModel& model,
                                                const std::vector<int>& order);

// Median angle between the rays of the points that both pictures see, degrees; 0 when they share
// none.
double MedianParallaxDeg(const SparseModel& model, const PosedImage& image1,
                         const PosedImage& image2);

// Share of the points that a picture sees which project into another; 0 when it sees none.
double SharedShare(const SparseModel& model, const PosedImage& image, const View& other);

// Angle between the rays from two camera centres to a point, degrees.
double ParallaxDeg(const Eigen::Vector3d& point, const Eigen::Vector3d& center1,
                   const Eigen::Vector3d& center2);

}  // namespace colmap_seapoint
