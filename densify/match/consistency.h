// What two views cannot agree on is taken out again (ours).
#pragma once

#include "densify/match/rectification.h"
#include "densify/match/sample_grid.h"
#include "densify/match/surface_fit.h"

namespace colmap_seapoint {

// Takes out nodes that claim the same place in picture 2 as a better one, nodes that disagree with
// their neighbours, and specks of a few nodes. What is reconstructed already supports its
// neighbours, so that the rim of a new area stays.
void RemoveInconsistent(const Gate& gate, PartialDisparity* nodes);

// Takes out refined samples that the gate does not admit, and samples that claim the same place in
// picture 2 as a better one.
void RemoveContradictions(const Gate& gate, int num_threads, PartialDisparity* samples);

// Takes out samples of the fitted surface that hardly any other agrees with, samples whose
// confidence is less than the smallest, and samples whose two rays meet at less than two degrees:
// near the epipole of a picture taken in the direction of motion, and far away, depth is a guess,
// whatever the correlation says.
void RemoveUnsure(const PairGeometry& geometry, float min_confidence, int num_threads,
                  PartialSurface* surface);

}  // namespace colmap_seapoint
