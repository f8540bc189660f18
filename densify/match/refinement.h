// From the coarse disparities that propagation found to a disparity a sample (ours): every sample
// is matched anew by a window that follows the surface through the nodes around it, on either side
// of a depth edge by that side's surface.
#pragma once

#include "densify/match/rectification.h"
#include "densify/match/sample_grid.h"

namespace colmap_seapoint {

struct RefinementOptions {
  int window_size;  // correlation window, pixels
  float min_zncc;
  int step;  // pixels between samples
};

// How far samples may lie from a matched node, in nodes: the surface is followed into what
// propagation could not match.
inline constexpr int kMaxRefinementSpread = 4;

// `nodes` come from Propagate. Samples lie in the surroundings of matched nodes
// (kMaxRefinementSpread), never at closed ones. Tiles of 64 x 32 pixels are independent: the same
// result for any number of threads. Cost: about 10 ns a pixel of the tiles that hold nodes,
// whatever the window; memory: the result's.
PartialDisparity Refine(const RectPicture& picture1, const RectPicture& picture2, const Gate& gate,
                        const PartialDisparity& nodes, const RefinementOptions& options,
                        int num_threads);

}  // namespace colmap_seapoint
