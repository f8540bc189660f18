#include "feature/matching/flow_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "feature/matching/local_flow.h"

namespace colmap_seapoint {

namespace {

bool Agree(const Eigen::Vector2f& a, const Eigen::Vector2f& b, const FlowFilterOptions& options,
           float min_cos) {
  if ((a - b).norm() < static_cast<float>(options.min_tolerance)) return true;
  const float norm_a = a.norm(), norm_b = b.norm();
  if (std::abs(norm_a - norm_b) >
      static_cast<float>(options.max_norm_difference) * std::max(norm_a, norm_b)) {
    return false;
  }
  return a.dot(b) >= min_cos * norm_a * norm_b;
}

// The middle of the rectangle that holds all points: as near to the middle of the picture as they
// can tell.
Eigen::Vector2f MiddleOf(const std::vector<SeaPoint>& points) {
  Eigen::Vector2f low(points[0].x, points[0].y), high = low;
  for (const SeaPoint& point : points) {
    low = low.cwiseMin(Eigen::Vector2f(point.x, point.y));
    high = high.cwiseMax(Eigen::Vector2f(point.x, point.y));
  }
  return 0.5f * (low + high);
}

std::vector<Eigen::Vector2f> FlowVectors(const std::vector<SeaPoint>& points1,
                                         const std::vector<SeaPoint>& points2,
                                         const FeatureMatches& matches, double turn) {
  const Eigen::Matrix2f rotation = Eigen::Rotation2Df(static_cast<float>(turn)).toRotationMatrix();
  const Eigen::Vector2f middle = MiddleOf(points1);
  std::vector<Eigen::Vector2f> vectors;
  vectors.reserve(matches.size());
  for (const FeatureMatch& match : matches) {
    const Eigen::Vector2f from(points1[match.idx1].x, points1[match.idx1].y);
    const Eigen::Vector2f to(points2[match.idx2].x, points2[match.idx2].y);
    vectors.emplace_back(to - middle - rotation * (from - middle));
  }
  return vectors;
}

// The vote of the neighbours (paper 2.4, Figure 8).
FeatureMatches KeepVoted(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                         const FeatureMatches& matches, double turn,
                         const FlowFilterOptions& options) {
  const std::vector<Eigen::Vector2f> vectors = FlowVectors(points1, points2, matches, turn);
  LocalFlow flow(points1, points2, matches);
  const float min_cos = static_cast<float>(std::cos(options.max_angle_deg * M_PI / 180));
  const size_t num_queried = static_cast<size_t>(options.num_neighbors) + 1;  // itself is one
  FeatureMatches kept;
  for (uint32_t i = 0; i < matches.size(); ++i) {
    int votes = 0;
    for (const uint32_t neighbor : flow.Nearest(points1[matches[i].idx1], num_queried)) {
      if (neighbor != i && Agree(vectors[i], vectors[neighbor], options, min_cos)) ++votes;
    }
    if (votes >= options.min_votes) kept.push_back(matches[i]);
  }
  return kept;
}

// The second look at what the vote has kept (ours).
FeatureMatches DropSlipped(const std::vector<SeaPoint>& points1,
                           const std::vector<SeaPoint>& points2, const FeatureMatches& matches,
                           const FlowFilterOptions& options) {
  if (matches.size() <= LocalFlow::kNumNeighbors) return matches;
  LocalFlow flow(points1, points2, matches);
  const std::vector<double> slips = flow.Slips();
  FeatureMatches kept;
  for (uint32_t i = 0; i < matches.size(); ++i) {
    const double usual = flow.UsualSlip(points1[matches[i].idx1], slips, i);
    if (slips[i] <= std::max(options.max_slip, options.max_slip_ratio * usual)) {
      kept.push_back(matches[i]);
    }
  }
  return kept;
}

}  // namespace

FeatureMatches FilterFlow(const std::vector<SeaPoint>& points1,
                          const std::vector<SeaPoint>& points2, const FeatureMatches& matches,
                          double turn, const FlowFilterOptions& options) {
  if (matches.empty()) return {};
  return DropSlipped(points1, points2, KeepVoted(points1, points2, matches, turn, options),
                     options);
}

}  // namespace colmap_seapoint
