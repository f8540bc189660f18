// How to swim so that a gap closes: parallel lines over it, and one short route over all gaps.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "densify/completeness/gaps/gap_regions.h"

namespace colmap_seapoint {

// Of the survey that is to be continued.
struct PassPlan {
  double altitude = 1;  // units above the surface, as the survey was taken from
  double across = 1,
         along = 1;  // units that a picture shows across and along the way, at that altitude
  double forward_overlap = 0.7, side_overlap = 0.5;
};

struct ClosingPass {
  // Camera centres at both ends of every line, in the order in which they are taken, world: line k
  // runs from corner 2 k to corner 2 k + 1, the next one back.
  std::vector<Eigen::Vector3d> corners;
  double heading_deg = 0;  // of the first line in the map, clockwise from ahead (north), 0..360
  double altitude = 0;     // units above the surface
  double tilt_deg = 0;     // of the camera: 0 straight down, 90 level, 180 straight up
  int num_lines = 0;
  int num_pictures = 0;
  double length = 0;  // units, the ways between lines included

  const Eigen::Vector3d& Begin() const { return corners.front(); }
  const Eigen::Vector3d& End() const { return corners.back(); }
};

// Lines along the gap's longer direction, half a picture longer than it at both ends, as many as
// its width needs with the side overlap, two at least where one would leave the gap with the rim of
// a single line; enough pictures that every place is seen twice.
ClosingPass PlanPass(const Ground& ground, const GapRegion& region, const PassPlan& plan);

struct RouteStop {
  int pass = 0;
  bool is_reversed = false;
};

// An order in which all passes are swum, each from either end, beginning anywhere, so that the ways
// between them are short. Up to 8 passes: the shortest there is; more: from the best of 8 greedy
// starts by exchanging and reversing (2-opt). Deterministic.
std::vector<RouteStop> PlanRoute(const std::vector<ClosingPass>& passes);
// Of the ways between passes, without these; units.
double TransitLength(const std::vector<ClosingPass>& passes, const std::vector<RouteStop>& route);

}  // namespace colmap_seapoint
