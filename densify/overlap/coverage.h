// What is reconstructed already, as a compact summary a pair, and how it looks from another picture
// (ours; paper 4 names redundancy between non-successive views as a limitation). The poses are
// known, so a place seen before is recognised wherever and whenever that was.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/rigid3.h"
#include "densify/match/cell_grid.h"
#include "densify/overlap/packed_footprint.h"

namespace colmap_seapoint {

// Share of its samples that makes a cell covered.
inline constexpr float kMinCoveredCell = 0.9f;

// A picture's cells: distance from the camera centre to the surface that is reconstructed there;
// 0 where nothing is.
struct ViewCoverage {
  CellGrid grid;
  std::vector<float> range;  // world units
  // Of its farthest part in the cell, where it runs away from the camera (a seabed seen at a
  // grazing angle): up to 1.15 times as far.
  std::vector<float> far = std::vector<float>(range.size(), 0.0f);

  double CoveredShare() const;
};

// Projects all footprints into a picture; the nearest surface wins. O(patches of footprints whose
// sphere may be in view).
ViewCoverage ProjectCoverage(const std::vector<PackedFootprint>& footprints, const Camera& camera,
                             const Rigid3d& cam_from_world, const CellGrid& grid);

// Adds one footprint to it.
void AddCoverage(const PackedFootprint& footprint, const Camera& camera,
                 const Rigid3d& cam_from_world, ViewCoverage* coverage);

}  // namespace colmap_seapoint
