#include "densify/completeness/gaps/closing_pass.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr double kDegPerRad = 180 / 3.14159265358979323846;

// The gap's own axes in its layer's plan, and its extent along them.
struct Extent {
  Eigen::Vector2d center, along, across;
  double low = 0, high = 0, half_width = 0;
};

Extent ExtentOf(const GapRegion& region, double side) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  const auto middle = [&](const std::pair<int, int>& cell) {
    return Eigen::Vector2d((cell.first + 0.5) * side, (cell.second + 0.5) * side);
  };
  for (const auto& cell : region.cells) mean += middle(cell);
  mean /= static_cast<double>(region.cells.size());
  Eigen::Matrix2d spread = 1e-12 * side * side * Eigen::Matrix2d::Identity();
  for (const auto& cell : region.cells) {
    const Eigen::Vector2d d = middle(cell) - mean;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  Extent extent;
  extent.along = solver.eigenvectors().col(1);
  if (extent.along.y() < 0) extent.along = -extent.along;
  extent.across = {extent.along.y(), -extent.along.x()};
  double left = 0, right = 0;
  for (const auto& cell : region.cells) {
    const Eigen::Vector2d d = middle(cell) - mean;
    extent.low = std::min(extent.low, d.dot(extent.along) - 0.5 * side);
    extent.high = std::max(extent.high, d.dot(extent.along) + 0.5 * side);
    left = std::min(left, d.dot(extent.across) - 0.5 * side);
    right = std::max(right, d.dot(extent.across) + 0.5 * side);
  }
  extent.center = mean + 0.5 * (left + right) * extent.across;
  extent.half_width = 0.5 * (right - left);
  return extent;
}

double HeadingDeg(const Eigen::Vector3d& in_map) {
  const double heading = std::atan2(in_map.x(), in_map.y()) * kDegPerRad;
  return heading < 0 ? heading + 360 : heading;
}

}  // namespace

ClosingPass PlanPass(const Ground& ground, const GapRegion& region, const PassPlan& plan) {
  const GroundLayer& layer = ground.layers.at(region.layer);
  const Extent extent = ExtentOf(region, ground.cell_side);
  ClosingPass pass;
  pass.altitude = plan.altitude;
  // A place must lie in two pictures of one line or another: the outermost lines run within the
  // gap's rim by no more than what a picture shows beside its middle.
  const double spacing = plan.across * (1 - plan.side_overlap);
  const double width = 2 * extent.half_width;
  pass.num_lines =
      1 + static_cast<int>(std::ceil(std::max(0.0, width - 0.8 * plan.across) / spacing));
  const Eigen::Matrix3d world_from_layer = layer.layer_from_world.transpose();
  for (int k = 0; k < pass.num_lines; ++k) {
    const double aside = (k - 0.5 * (pass.num_lines - 1)) * spacing;
    const double ends[2] = {extent.low - 0.5 * plan.along, extent.high + 0.5 * plan.along};
    for (int end = 0; end < 2; ++end) {
      const double at = ends[k % 2 == 0 ? end : 1 - end];
      const Eigen::Vector2d p = extent.center + at * extent.along + aside * extent.across;
      const double height = layer.surface.At(p.x(), p.y()).height + plan.altitude;
      pass.corners.push_back(world_from_layer * Eigen::Vector3d(p.x(), p.y(), height));
    }
  }
  const double line = extent.high - extent.low + plan.along;
  const double step = plan.along * (1 - plan.forward_overlap);
  pass.num_pictures = pass.num_lines * (1 + static_cast<int>(std::ceil(line / step)));
  for (size_t i = 1; i < pass.corners.size(); ++i) {
    pass.length += (pass.corners[i] - pass.corners[i - 1]).norm();
  }
  const Eigen::Matrix3d& map = ground.frame.map_from_world;
  pass.heading_deg = HeadingDeg(map * (pass.corners[1] - pass.corners[0]));
  const Eigen::Vector3d outward = map * layer.layer_from_world.row(2).transpose();
  pass.tilt_deg = std::acos(std::clamp(outward.z(), -1.0, 1.0)) * kDegPerRad;
  return pass;
}

}  // namespace colmap_seapoint
