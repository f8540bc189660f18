// The surfaces that the nodes of a tile lie on: one, or several where depth edges run through it.
#pragma once

#include <array>
#include <functional>

#include "densify/kernels/tile_kernels.h"
#include "densify/match/sample_grid.h"

namespace colmap_seapoint {

inline constexpr float kMaxLayerSlope = 2.0f;  // pixels of disparity a pixel, on one surface

// One mark for each of a tile's nodes and of the ring of nodes around them, [row][column] as in
// tile::Prediction.
using NodeMarks = std::array<std::array<bool, tile::kNodesX>, tile::kNodesY>;

struct SurfaceLayer {
  tile::Prediction surface;  // continued as far as windows around `near` reach
  NodeMarks near;            // the tile's own nodes that it may fill: open, on it or beside it
  int u0, v0, u1, v1;        // a box around these, u1 and v1 one beyond
};

// Calls visit for each surface of a tile: nodes that hang together with no depth edge between them,
// at least three. Nodes closed by the gate are not filled.
void ForEachLayer(const PartialDisparity& nodes, const Gate& gate, int tile_a, int tile_b,
                  const std::function<void(const SurfaceLayer&)>& visit);

}  // namespace colmap_seapoint
