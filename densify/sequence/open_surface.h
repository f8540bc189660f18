// What a picture sees and no pair has covered, as places in the world: at the ranges that its
// neighbourhood lets expect (ours).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "densify/match/cell_grid.h"
#include "densify/match/view.h"
#include "densify/overlap/coverage.h"

namespace colmap_seapoint {

// Range of the surface in every cell of the picture: what is reconstructed there, and elsewhere
// that of the nearest cell that is reconstructed or holds a triangulated point. All 0 when there is
// neither. (The mapper drops points that only two pictures see, so the rim, which matters most
// to the completion pass, has none of its own.)
std::vector<double> PredictRanges(const SparseModel& model, const PosedImage& image,
                                  const View& view, const ViewCoverage& coverage);

// The point of the world that a cell's centre shows at a range; nullopt where the camera has no
// ray.
std::optional<Eigen::Vector3d> PointAt(const View& view, const Rigid3d& world_from_cam,
                                       const CellGrid& grid, size_t cell, double range);

// Whether a point lies in the picture, away from its rim by a hundredth of its sides: no window
// fits nearer.
bool SeesWell(const View& view, const Eigen::Vector3d& point);

template <typename Visit>
void ForEachNeighbor(const CellGrid& grid, size_t cell, const Visit& visit) {
  const size_t width = static_cast<size_t>(grid.width);
  if (cell % width > 0) visit(cell - 1);
  if (cell % width + 1 < width) visit(cell + 1);
  if (cell >= width) visit(cell - width);
  if (cell + width < grid.Size()) visit(cell + width);
}

}  // namespace colmap_seapoint
