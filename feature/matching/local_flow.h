// Where picture 2 shows a place of picture 1, after the matches around it (ours).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "feature/matching/seapoint_tree.h"

namespace colmap_seapoint {

// Keeps references. Not for two threads at once.
class LocalFlow {
 public:
  LocalFlow(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
            const FeatureMatches& matches);

  // Indices of the up to `count` matches that start nearest to a place of picture 1, nearest first.
  const std::vector<uint32_t>& Nearest(const SeaPoint& place, size_t count);

  // The similarity transform (least squares) of the kNumNeighbors nearest matches, at `place`;
  // where they all start in about one place their mean shift alone. `left_out`: a match that has no
  // say. NaN without any match.
  Eigen::Vector2d Predict(const SeaPoint& place, std::optional<uint32_t> left_out = std::nullopt);

  // By match: how far it ends from where the matches around it say, pixels.
  std::vector<double> Slips();

  // Median of `slips` (of Slips()) over the kNumNeighbors matches nearest to `place`: what relief
  // and noise make usual there. `left_out` as above. 0 without any match.
  double UsualSlip(const SeaPoint& place, const std::vector<double>& slips,
                   std::optional<uint32_t> left_out = std::nullopt);

  static constexpr size_t kNumNeighbors = 10;

 private:
  const std::vector<SeaPoint>&points1_, &points2_;
  const FeatureMatches& matches_;
  SeaPointTree tree_;
  std::vector<uint32_t> neighbors_;
  std::vector<double> around_;
};

}  // namespace colmap_seapoint
