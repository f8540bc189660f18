// Whether the links between two models can be trusted (ours).
//
// That many agree is not enough: a thing that is there twice, or a picture of it, links two places
// as firmly as a true overlap does. What tells them apart is what is not linked: around the thing,
// pictures that would look at the same ground from the same side have been compared, and nothing
// matched.
#pragma once

#include <string>

#include "colmap_seapoint/joining/link_consensus.h"

namespace colmap_seapoint {

struct LinkEvidence {
  size_t num_points = 0;      // of `a` that are linked
  size_t num_pictures_a = 0;  // that show them
  size_t num_pictures_b = 0;
  size_t num_cells = 0;   // of b's pictures (6 x 6 each) where both models have ground at one
                          // depth, seen from one side by pictures that were compared, or a link
  size_t num_linked = 0;  // of these cells, those with a link
};

LinkEvidence WeighLinks(const SparseModel& a, const SparseModel& b, const ModelLinks& links,
                        const LinkConsensus& consensus);

// Why the models are better left apart; "" when nothing speaks against joining them.
std::string Doubt(const LinkEvidence& evidence, const LinkConsensus& consensus);

}  // namespace colmap_seapoint
