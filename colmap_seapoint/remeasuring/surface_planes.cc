#include "colmap_seapoint/remeasuring/surface_planes.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>

#include "colmap_seapoint/base/median.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kNumNeighbours = 12;
constexpr size_t kMinNeighbours = 4;
constexpr int kNumRounds = 4;
// A facing surface counts as much as this share of the neighbours: it decides only where these
// lie on a line.
constexpr double kFacingWeight = 0.01;
// tan(75 degrees): of the slope that a plane has against one that faces the camera.
constexpr double kMaxTilt = 3.7;

// The points' directions, as nanoflann asks for them.
struct Directions {
  const std::vector<SeenPoint>& points;

  size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(size_t i, size_t axis) const {
    return points[i].direction[static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Directions>,
                                                 Directions, 2, uint32_t>;

// A neighbour as seen from the point that the plane goes through.
struct Step {
  Eigen::Vector2d direction;
  double inverse_depth;
};

std::vector<Step> StepsFrom(const SeenPoint& point, const Tree& tree,
                            const std::vector<SeenPoint>& points) {
  std::array<uint32_t, kNumNeighbours + 1> nearest;  // the point itself is one of them
  std::array<double, kNumNeighbours + 1> squared;
  const size_t found =
      tree.knnSearch(point.direction.data(), nearest.size(), nearest.data(), squared.data());
  std::vector<Step> steps;
  for (size_t k = 0; k < found; ++k) {
    const SeenPoint& other = points[nearest[k]];
    if (other.direction == point.direction) continue;
    steps.push_back({other.direction - point.direction, other.inverse_depth - point.inverse_depth});
  }
  return steps;
}

double MedianResidual(const std::vector<Step>& steps, const Eigen::Vector2d& slope) {
  std::vector<double> residuals;
  for (const Step& step : steps) {
    residuals.push_back(std::abs(step.inverse_depth - slope.dot(step.direction)));
  }
  return UpperMedian(std::move(residuals));
}

// `weigh` tells how much a residual counts.
template <typename Weight>
Eigen::Vector2d WeightedSlope(const std::vector<Step>& steps, const Weight& weigh) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  double sum = 0;
  for (const Step& step : steps) {
    const double weight = weigh(step);
    normal += weight * step.direction * step.direction.transpose();
    right += weight * step.inverse_depth * step.direction;
    sum += weight * step.direction.squaredNorm();
  }
  normal += kFacingWeight * sum * Eigen::Matrix2d::Identity();
  return normal.inverse() * right;
}

// From least squares, or from a surface that faces the camera where that is nearer to most: least
// squares follow what lies off too far.
Eigen::Vector2d StartSlope(const std::vector<Step>& steps) {
  const Eigen::Vector2d slope = WeightedSlope(steps, [](const Step&) { return 1.0; });
  const Eigen::Vector2d facing = Eigen::Vector2d::Zero();
  return MedianResidual(steps, slope) < MedianResidual(steps, facing) ? slope : facing;
}

Eigen::Vector2d FitSlope(const std::vector<Step>& steps) {
  Eigen::Vector2d slope = StartSlope(steps);
  for (int round = 0; round < kNumRounds; ++round) {
    const double scale = 1.5 * MedianResidual(steps, slope) + 1e-12;
    slope = WeightedSlope(steps, [&](const Step& step) {
      const double residual = (step.inverse_depth - slope.dot(step.direction)) / scale;
      return 1 / ((1 + residual * residual) * (1 + residual * residual));
    });
  }
  return slope;
}

// The plane's normal is (slope, w - slope . direction) in the camera's frame.
bool IsSeenWell(const SeenPlane& plane) {
  const double depthward = plane.through.inverse_depth - plane.slope.dot(plane.through.direction);
  return depthward > 0 && plane.slope.norm() <= kMaxTilt * depthward;  // false for NaN
}

}  // namespace

std::optional<Eigen::Vector3d> SeenPlane::At(const Eigen::Vector2d& direction) const {
  const double inverse_depth = through.inverse_depth + slope.dot(direction - through.direction);
  if (!(inverse_depth > 0)) return std::nullopt;
  return direction.homogeneous() / inverse_depth;
}

std::vector<SeenPlane> FitPlanes(const std::vector<SeenPoint>& points,
                                 const std::vector<size_t>& wanted) {
  std::vector<SeenPlane> planes;
  if (wanted.empty()) return planes;
  const Directions directions = {points};
  Tree tree(2, directions, nanoflann::KDTreeSingleIndexAdaptorParams(8));
  tree.buildIndex();
  for (const size_t i : wanted) {
    SeenPlane plane = {points[i]};
    const std::vector<Step> steps = StepsFrom(points[i], tree, points);
    if (steps.size() >= kMinNeighbours) plane.slope = FitSlope(steps);
    if (!IsSeenWell(plane)) plane.slope.setZero();
    planes.push_back(plane);
  }
  return planes;
}

}  // namespace colmap_seapoint
