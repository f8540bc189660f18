// Whether residuals look like those of a port that bends rays at its own place, not at the lens's.
#pragma once

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// Rays through a flat port do not meet in one point: the farther from the axis, the farther before
// the lens they seem to cross it. A lens is adjusted for the mean distance of the ground; what is
// nearer or farther is then off along the radius, by the radius cubed times how much nearer it is.
// Returned is that slope in units of its standard error, pictures being independent; about normal
// where there is nothing of the kind. 0 for fewer than 3 pictures.
double RefractionSign(const SparseModel& model);

}  // namespace colmap_seapoint
