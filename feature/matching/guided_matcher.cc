#include "feature/matching/guided_matcher.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <vector>

#include "feature/matching/hamming_matcher.h"
#include "feature/matching/local_flow.h"
#include "feature/matching/overlap_share.h"
#include "feature/matching/seapoint_tree.h"

namespace colmap_seapoint {

namespace {

constexpr size_t kMinFlow = 20;  // inliers that make a flow
// Chance agreement between pictures of different places must not be made more of; in murk, guided
// matching is what brings true pairs above kMinOverlapShare.
constexpr double kMinShareOfOverlap = 0.5 * kMinOverlapShare;

struct Candidate {
  int distance;
  uint32_t idx1, idx2;
  bool operator<(const Candidate& other) const {
    return std::tie(distance, idx1, idx2) < std::tie(other.distance, other.idx1, other.idx2);
  }
};

// The distance to the epipolar line (Sampson) in pixels: on rays and by E where the cameras are
// calibrated, on pixels and by F where they are not.
class EpipolarError {
 public:
  EpipolarError(const Camera& camera1, const std::vector<SeaPoint>& points1, const Camera& camera2,
                const std::vector<SeaPoint>& points2, const TwoViewGeometry& geometry) {
    const bool by_rays = !geometry.F.has_value();
    matrix_ = by_rays ? *geometry.E : *geometry.F;
    scale_ = by_rays ? 0.5 * (camera1.MeanFocal() + camera2.MeanFocal()) : 1;
    places1_ = Places(by_rays ? &camera1 : nullptr, points1);
    places2_ = Places(by_rays ? &camera2 : nullptr, points2);
  }

  double operator()(uint32_t idx1, uint32_t idx2) const {
    const Eigen::Vector3d line2 = matrix_ * places1_[idx1];
    const Eigen::Vector3d line1 = matrix_.transpose() * places2_[idx2];
    const double norm = std::sqrt(line1.head<2>().squaredNorm() + line2.head<2>().squaredNorm());
    return scale_ * std::abs(places2_[idx2].dot(line2)) / norm;  // NaN where a pixel has no ray
  }

 private:
  static std::vector<Eigen::Vector3d> Places(const Camera* camera,
                                             const std::vector<SeaPoint>& points) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    std::vector<Eigen::Vector3d> places;
    places.reserve(points.size());
    for (const SeaPoint& point : points) {
      const Eigen::Vector2d pixel(point.x, point.y);
      const std::optional<Eigen::Vector2d> place =
          camera == nullptr ? std::optional(pixel) : camera->CamFromImg(pixel);
      places.push_back(place ? place->homogeneous().eval() : Eigen::Vector3d(kNone, kNone, 1));
    }
    return places;
  }

  Eigen::Matrix3d matrix_;
  double scale_;
  std::vector<Eigen::Vector3d> places1_, places2_;
};

// Tells which SeaPoints of the two pictures are matched already.
struct Taken {
  Taken(const Features& features1, const Features& features2, const FeatureMatches& matches)
      : in1(features1.points.size(), 0), in2(features2.points.size(), 0) {
    for (const FeatureMatch& match : matches) Take(match);
  }
  void Take(const FeatureMatch& match) { in1[match.idx1] = in2[match.idx2] = 1; }
  bool Holds(const FeatureMatch& match) const { return in1[match.idx1] || in2[match.idx2]; }

  std::vector<uint8_t> in1, in2;
};

// Pairs of unmatched SeaPoints that lie where the flow and the epipolar line say, and look alike.
std::vector<Candidate> FindCandidates(const Features& features1, const Features& features2,
                                      const FeatureMatches& inliers, const EpipolarError& error,
                                      const Taken& taken, const GuidedMatcherOptions& options) {
  LocalFlow flow(features1.points, features2.points, inliers);
  const std::vector<double> slips = flow.Slips();
  SeaPointTree targets(features2.points);
  std::vector<uint32_t> nearby;
  std::vector<Candidate> candidates;
  for (uint32_t i = 0; i < features1.points.size(); ++i) {
    if (taken.in1[i]) continue;
    const SeaPoint& point = features1.points[i];
    const Eigen::Vector2d place = flow.Predict(point);
    const double radius =
        std::max(options.max_slip, options.max_slip_ratio * flow.UsualSlip(point, slips));
    targets.Within(static_cast<float>(place.x()), static_cast<float>(place.y()),
                   static_cast<float>(radius), &nearby);
    for (const uint32_t j : nearby) {
      if (taken.in2[j] || !(error(i, j) <= options.max_error)) continue;
      const int distance = HammingDistance(features1.descriptors[i], features2.descriptors[j]);
      if (distance <= options.max_distance) candidates.push_back({distance, i, j});
    }
  }
  return candidates;
}

// One-to-one, the smallest distance first. Sorted by idx1.
FeatureMatches ChooseNearest(std::vector<Candidate> candidates, Taken taken) {
  std::sort(candidates.begin(), candidates.end());
  FeatureMatches chosen;
  for (const Candidate& candidate : candidates) {
    const FeatureMatch match = {candidate.idx1, candidate.idx2};
    if (taken.Holds(match)) continue;
    taken.Take(match);
    chosen.push_back(match);
  }
  std::sort(chosen.begin(), chosen.end(),
            [](const FeatureMatch& a, const FeatureMatch& b) { return a.idx1 < b.idx1; });
  return chosen;
}

}  // namespace

FeatureMatches MatchGuided(const Camera& camera1, const Features& features1, const Camera& camera2,
                           const Features& features2, const FeatureMatches& matches,
                           const TwoViewGeometry& geometry, const GuidedMatcherOptions& options) {
  if (!options.enabled || geometry.inliers.size() < kMinFlow) return {};
  if (!geometry.E && !geometry.F) return {};
  if (OverlapShare(features1.points, features2.points, geometry.inliers) < kMinShareOfOverlap) {
    return {};
  }
  const EpipolarError error(camera1, features1.points, camera2, features2.points, geometry);
  const Taken taken(features1, features2, matches);
  return ChooseNearest(
      FindCandidates(features1, features2, geometry.inliers, error, taken, options), taken);
}

}  // namespace colmap_seapoint
