// What an earlier run has reconstructed of a survey that has grown since (ours): its pictures have
// had their turn, and its cloud is known surface to those that came in.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "densify/match/cell_grid.h"
#include "densify/match/view.h"
#include "densify/overlap/packed_footprint.h"

namespace colmap_seapoint {

struct EarlierSurface {
  int num_pictures = 0;  // those with a smaller image_idx have had their turn
  std::vector<PackedFootprint> footprints;
};

// Which pictures of a model begin pairs. Any picture may complete a pair.
struct SequenceScope {
  EarlierSurface earlier;
  int block = 1, num_blocks = 1;  // of the track, cut into parts of as many pictures
};

// Where the points of a pair lie, as the cells of its first picture: what TallyCells() knew when
// they were made, near enough. `points`: world; `step`: SampleStep(). A cell counts when it holds
// seven tenths of its samples: the rectified frame has some more, or fewer, than the picture.
// O(points).
CloudFootprint FootprintOf(const std::vector<Eigen::Vector3f>& points, const View& view,
                           const CellGrid& cells, int step);

}  // namespace colmap_seapoint
