// What two pictures of a model share, by its triangulated points, and how well the two of them
// measure it (ours).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// How well two views measure a place, 0 .. 1, from the angle between their rays to it and from
// their distances. Too small an angle measures no depth, too large a one shows two surfaces; and
// what one view sees at several times the other's distance looks different in it.
double ViewQuality(const Eigen::Vector3d& point, const Eigen::Vector3d& center1,
                   const Eigen::Vector3d& center2);

// What a picture shares with another one.
struct SharedPoints {
  int image_idx = -1;  // the other one
  double count = 0;    // triangulated points that both see
  double quality = 0;  // sum of their ViewQuality
};

// For every picture (image_idx) those that share points with it, by ascending image_idx.
using Covisibility = std::vector<std::vector<SharedPoints>>;

// Of a track longer than 24 pictures (video, a carrier that hovers) 24 count, drawn by the point's
// id, and each pair of them for as many as it stands for: exact for short tracks, an estimate
// without bias for long ones. O(24^2) a point. The order of a track's elements does not matter.
Covisibility MeasureCovisibility(const SparseModel& model);

// Median angle between the rays of the points that both pictures see, degrees; nullopt when
// they share none.
std::optional<double> MedianParallaxDeg(const SparseModel& model, const PosedImage& image1,
                                        const PosedImage& image2);

// Triangulated points that both pictures see.
int NumSharedPoints(const PosedImage& image1, const PosedImage& image2);

// Angle between the rays from two camera centres to a point, degrees.
double ParallaxDeg(const Eigen::Vector3d& point, const Eigen::Vector3d& center1,
                   const Eigen::Vector3d& center2);

}  // namespace colmap_seapoint
