// What two views cannot agree on is taken out again (ours).
#pragma once

#include "densify/match/rectification.h"
#include "densify/match/sample_grid.h"
#include "densify/match/surface_fit.h"

namespace colmap_seapoint {

// Of the nodes: those that claim the same place in picture 2 as a better one, those that disagree
// with their neighbours, and specks. What is reconstructed already supports its neighbours.
void RemoveInconsistent(const Gate& gate, PartialDisparity* nodes);

// Of the refined samples: those that the gate does not admit, and those that claim the same place
// in picture 2 as a better one.
void RemoveContradictions(const Gate& gate, int num_threads, PartialDisparity* samples);

// Samples of the fitted surface that hardly any other agrees with, and those whose two rays meet at
// less than a degree: near the epipole of a picture taken in the direction of motion, depth is a
// guess.
void RemoveUnsupported(const PairGeometry& geometry, PartialSurface* surface);

}  // namespace colmap_seapoint
