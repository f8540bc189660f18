// Whether points lie so smoothly that they can be believed.
#pragma once

#include "densify/completeness/surface/ground.h"

namespace colmap_seapoint {

// Of 25 cells around one: whether their neighbours lie at the same height as they do, to what a
// spacing is worth, 3 of 8 in the mean. What blurred pictures alone have measured is believed then.
// It is no single cell's business: where a place is rough some cells agree by chance, and most
// cells that stand out of a smooth one are right all the same.
bool IsSmoothAround(const GroundLayer& layer, int x, int y, double cell_side);

}  // namespace colmap_seapoint
