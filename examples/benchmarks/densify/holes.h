// Holes inside the outline of a cloud that is seen from above: what a survey should have shown and
// did not, measured without a truth.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/io/cloud/ply.h"

namespace colmap_seapoint {

// A connected patch (over edges and corners) of empty cells.
struct Hole {
  double area = 0;                                   // model units squared
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // model frame, at the mean height of its rim
  int column = 0, row = 0;                           // the same place in the map
};

struct HoleMap {
  double spacing = 0, cell = 0;  // model units
  double area = 0;               // inside the outline
  double occupied_area = 0;      // of it, cells that hold a point
  double hole_share = 0;         // of the inner outline
  std::vector<Hole> holes;       // the largest first
  ColorImage picture;            // one pixel a cell: brighter where higher, red in holes
};

// The median distance from a point to the nearest other place, at up to 200,000 points. Throws
// Error for a cloud of fewer than two places.
double MedianSpacing(const std::vector<CloudPoint>& cloud);

// On the cloud's best plane (PlanView) lies a grid of cells 3 spacings wide. The occupied cells are
// closed by 8 cells (a disc), so that narrow bays at the rim count and wide ones do not; the
// outline is the largest connected patch of that, all that it encloses included. Without the 2
// outermost cells, where the rim of the cloud frays, it is the inner outline; its empty cells are
// the holes. `spacing`: between samples, model units; figures are comparable at the same spacing
// only. What lies far outside of 99.8 % of the points is not looked at. Throws Error for an empty
// cloud and for a grid of more than 400 million cells. 1 CPU second for three million points.
HoleMap FindHoles(const std::vector<CloudPoint>& cloud, double spacing);

// Lines to read; the `num_holes` largest holes are listed.
std::string HolesText(const HoleMap& map, size_t num_holes);

}  // namespace colmap_seapoint
