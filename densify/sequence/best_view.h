// The best view first (paper 4; ours): a place is left to the pictures that measure it best, where
// later ones come much nearer to it or see it at a larger parallax. A swimmer who looks ahead sees
// every place from afar before he is there: whatever came first would fill the cloud with the
// poorest view of everything.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "densify/match/cell_grid.h"
#include "densify/match/view.h"

namespace colmap_seapoint {

// How far the distance of a place is off, model units, when the two views disagree by a pixel of
// the coarser one: its ground sampling distance over their parallax, which counts up to 11.5
// degrees. Infinite where either does not see the place well, or their rays meet at less than two
// degrees.
double RangeUncertainty(const View& view1, const View& view2, const Eigen::Vector3d& place);

// For each cell of `view` the largest uncertainty with which one of its pairs may measure it before
// the others have had their turn: half as much again as that of the best two of `view` and `others`
// for what lies there at its predicted range (PredictRanges); infinite where nothing is predicted
// or no two measure it. Looked up once for 4 x 4 cells. O(cells / 16 * views^2).
std::vector<double> AdmissibleUncertainty(const View& view, const std::vector<View>& others,
                                          const CellGrid& grid,
                                          const std::vector<double>& predicted_range);

// Closes the cells that `partner` would measure with more than the admissible uncertainty.
void LeaveToBetterPairs(const View& view, const View& partner,
                        const std::vector<double>& predicted_range,
                        const std::vector<double>& admissible, KnownCells* known);

}  // namespace colmap_seapoint
