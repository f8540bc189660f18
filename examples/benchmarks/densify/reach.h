// How much of a peer's cloud ours reaches, where no truth is known: both are clouds of one model,
// and distances count in the peer's own local spacing, since a cloud is as sparse as its pictures
// are far.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace colmap_seapoint {

// Distances that are looked at, in local spacings of the peer.
inline constexpr double kReachSpacings[] = {1, 2, 4};

// One way: the shares of one cloud's points that have a point of the other no farther than so many
// local spacings, in the order of kReachSpacings.
struct ReachShares {
  size_t num_points = 0;       // of the nearer half
  std::vector<double> within;  // NaN when there is no point
};

struct Reach {
  double range_limit = 0;     // the nearer half ends here, model units
  double median_spacing = 0;  // local spacing of the peer in the nearer half, model units
  ReachShares peer, cloud;
};

// The nearer half: points no farther from their nearest camera than the median of the peer's points
// are; far away both clouds guess. The local spacing at a point of the peer is the median over it
// and its 8 nearest points of their distance to the nearest other place, which neither a doubled
// point nor an outlier moves. A point of ours is measured by the spacing at the peer's point
// nearest to it. Up to 200,000 points of either cloud are looked at, evenly spread over their
// order. `centers`: of the cameras, one at least. About 20 CPU seconds for two clouds of a few
// million. Throws Error for a peer of fewer than two places.
Reach MeasureReach(const std::vector<Eigen::Vector3f>& cloud,
                   const std::vector<Eigen::Vector3f>& peer,
                   const std::vector<Eigen::Vector3f>& centers);

// Lines to read, with a line of what they mean.
std::string ReachText(const Reach& reach);

}  // namespace colmap_seapoint
