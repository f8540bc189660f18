// Predicts where picture 2 shows a place of picture 1 from the matches around that place (ours).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "feature/matching/seapoint_tree.h"

namespace colmap_seapoint {

// Keeps references to what it is made from. Each thread needs its own: queries use scratch memory.
class LocalFlow {
 public:
  LocalFlow(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
            const FeatureMatches& matches);

  // Indices of the up to `count` matches that start nearest to a place of picture 1, nearest first.
  const std::vector<uint32_t>& Nearest(const SeaPoint& place, size_t count);

  // Moves `place` (pixels) by the similarity transform that fits its kNumNeighbors nearest matches
  // best (least squares), or by their mean shift where they all start in about one place.
  // `left_out` is a match that has no say. NaN without any match.
  Eigen::Vector2d Predict(const SeaPoint& place, std::optional<uint32_t> left_out = std::nullopt);

  // Returns, match by match, how far it ends from where the matches around it say, in pixels.
  std::vector<double> Slips();

  // Returns the median of `slips` (from Slips()) over the kNumNeighbors matches nearest to `place`:
  // relief and noise make that much usual there. `left_out` as above. 0 without any match.
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
