// How far, and with how little texture, a survey could measure: what it has covered tells that.
#pragma once

#include "densify/completeness/surface/ground.h"

namespace colmap_seapoint {

// GSD of the nearest picture, over the survey's own, beyond which a place is background.
inline constexpr double kFar = 2;

// A camera that looks ahead shows much that nobody meant to measure. What all pictures see from so
// far away is not expected, unless it is covered. Such cells keep their cause (outline.h).
void LeaveOutBackground(double survey_gsd, Ground* ground);

// Far patches, over open water and the like, are no part of the survey: what is missing around them
// is predicted from them alone. Of the top layer's parts that no expected cells connect, nothing
// that is missing is expected where less than a third is covered; but in the largest. After
// JudgeGround.
void LeaveOutIslands(Ground* ground);

// Texture, as in PictureFacts, from which on this survey's places were matched reliably: of what
// two pictures see with less, less than nine tenths as much is covered as of the texture that was
// matched best. Not above the median of what is covered, for most of what is can be matched; a
// quarter of it at the least, for of what hardly any place shows nothing is known. 0 where the
// pictures were not looked at. Of the top layer.
double ReliableTexture(const Ground& ground);

// Where two good pictures see a place from two sides, and it is missing all the same: kNoTexture
// below that texture; with more they disagree. That brightness differs tells nothing: lamps move.
void TellWhatLacksTexture(Ground* ground);

}  // namespace colmap_seapoint
