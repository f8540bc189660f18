// What can be said of a cloud without knowing the truth.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap_seapoint/compare/nearest.h"

namespace colmap_seapoint {

// A cloud that remembers which pair gave each point.
struct PairedCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<int> pair_idx;  // same length
};

// Mean number of pairs that gave points to an occupied cube of side `cell`: 1 = no redundancy, but
// for the seams between pairs. NaN for an empty cloud.
double MeanLayers(const PairedCloud& cloud, double cell);

// Each place once, in ascending order: a point's twin would be no spacing.
PointVector DistinctPlaces(const std::vector<Eigen::Vector3f>& points);

class NearestPoint {
 public:
  explicit NearestPoint(const std::vector<Eigen::Vector3f>& points);
  // Infinity for an empty cloud.
  double Distance(const Eigen::Vector3f& place) const;

 private:
  PointVector points_;
  PointIndex index_;
};

// Share of the reference's points (a sample of them, evenly spread) that have a point of the cloud
// within `distance`. NaN for an empty reference.
double ShareNear(const std::vector<Eigen::Vector3f>& reference,
                 const std::vector<Eigen::Vector3f>& cloud, double distance);

}  // namespace colmap_seapoint
