// Densification by propagation (paper 2.6, Figure 12): matches grow from seeds to neighbouring
// samples, generation by generation, until regions collide, match too badly, reach what is already
// reconstructed, or are too far from their seed.
#pragma once

#include <vector>

#include "densify/match/rectification.h"
#include "densify/match/sample_grid.h"

namespace colmap_seapoint {

struct PropagationOptions {
  int window_size;  // correlation window, pixels
  float min_zncc;
  int max_generations;  // the limit on expansion, in samples from the seed
};

// Disparities of the gate's nodes. The same result for any number of threads: a generation's
// candidates are scored against the state of the one before, and committed in raster order. Cost:
// about 12 windows a node.
PartialDisparity Propagate(const RectPicture& picture1, const RectPicture& picture2,
                           const Gate& gate, const std::vector<Seed>& seeds,
                           const PropagationOptions& options, int num_threads);

}  // namespace colmap_seapoint
