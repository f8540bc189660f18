// What no picture has seen, but should have: holes inside of the survey's outline, or of the asked
// area.
#pragma once

#include "densify/completeness/sight/lost_pictures.h"
#include "densify/completeness/surface/asked_area.h"

namespace colmap_seapoint {

struct OutlineLimits {
  double radius = 0;   // of the disc, units
  double max_gsd = 0;  // units a pixel: what all pictures see from farther away outlines nothing
};

// The outline is the closing of what is expected of the top layer and seen from near enough: all
// that a disc cannot reach from outside without touching it, and all that is enclosed. Cells inside
// of it that no picture saw become expected: kPoseLost where lost pictures must have been, else
// kNeverImaged; and so does background that is enclosed. With an asked area its inside takes the
// outline's place. Cells that are not there yet are made.
void JudgeUnseen(const OutlineLimits& limits, const AskedArea* asked, const LostSight& lost,
                 Ground* ground);

}  // namespace colmap_seapoint
