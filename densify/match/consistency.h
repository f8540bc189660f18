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

// Takes out samples of the fitted surface that hardly any other agrees with, and samples whose two
// rays meet at less than a degree: near the epipole of a picture taken in the direction of motion,
// depth is a guess.
void RemoveUnsupported(const PairGeometry& geometry, PartialSurface* surface);

}  // namespace colmap_seapoint
