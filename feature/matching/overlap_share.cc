#include "feature/matching/overlap_share.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

Eigen::Vector2d Place(const SeaPoint& point) { return {point.x, point.y}; }

// The rotation and displacement that bring the first points of the matches nearest to the second.
struct Motion {
  double cosine = 1, sine = 0;
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();

  Eigen::Vector2d operator()(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d p = place - from;
    return to + Eigen::Vector2d(cosine * p.x() - sine * p.y(), sine * p.x() + cosine * p.y());
  }
};

Motion FitMotion(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                 const FeatureMatches& matches) {
  Motion motion;
  for (const FeatureMatch& match : matches) {
    motion.from += Place(points1[match.idx1]) / static_cast<double>(matches.size());
    motion.to += Place(points2[match.idx2]) / static_cast<double>(matches.size());
  }
  double dot = 0, cross = 0;
  for (const FeatureMatch& match : matches) {
    const Eigen::Vector2d p = Place(points1[match.idx1]) - motion.from;
    const Eigen::Vector2d q = Place(points2[match.idx2]) - motion.to;
    dot += p.dot(q);
    cross += p.x() * q.y() - p.y() * q.x();
  }
  const double norm = std::hypot(dot, cross);
  if (norm > 0) {
    motion.cosine = dot / norm;
    motion.sine = cross / norm;
  }
  return motion;
}

}  // namespace

double OverlapShare(const std::vector<SeaPoint>& points1, const std::vector<SeaPoint>& points2,
                    const FeatureMatches& matches) {
  if (matches.empty()) return 0;
  const Motion motion = FitMotion(points1, points2, matches);
  // The second picture reaches as far as its SeaPoints do.
  Eigen::Vector2d low = Place(points2.front()), high = low;
  for (const SeaPoint& point : points2) {
    low = low.cwiseMin(Place(point));
    high = high.cwiseMax(Place(point));
  }
  const auto num_inside = std::count_if(points1.begin(), points1.end(), [&](const SeaPoint& point) {
    const Eigen::Vector2d place = motion(Place(point));
    return (place.array() >= low.array()).all() && (place.array() <= high.array()).all();
  });
  return static_cast<double>(matches.size()) /
         std::max(static_cast<double>(num_inside), static_cast<double>(matches.size()));
}

}  // namespace colmap_seapoint
