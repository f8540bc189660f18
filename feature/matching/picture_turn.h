// How far one picture is turned against another about its viewing direction: a vote of all their
// SeaPoints together (ours; in place of rBRIEF's orientation of every single point).
#pragma once

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {

// Steps of kTurnStep, 0..31, from x towards y, by which the scene of picture 1 is turned in picture
// 2: the turn at which the strongest SeaPoints of both find the nearest partners. 0 when nothing
// speaks for any turn (ties go to the smaller). Symmetric up to sign but for ties.
// Cost: 18 Hamming matchings of 400 x 400 points, about a third of one of 3000 x 3000.
int FindPictureTurn(const Features& features1, const Features& features2);

}  // namespace colmap_seapoint
