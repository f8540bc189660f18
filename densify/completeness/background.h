// What a survey shows beside what it was made to measure.
#pragma once

#include "densify/completeness/surface/ground.h"

namespace colmap_seapoint {

// GSD of the nearest picture, units a pixel, beyond which the survey's pictures mostly gave nothing, because that is too
// far away in the water, or seen at too grazing an angle: where less than half as much of what two
// pictures see is covered as where it is `survey_gsd` or less. Infinite where that is nowhere
// so. At least 1.5 survey_gsd. Of the top layer, after JudgeGround.
double LimitOfSight(double survey_gsd, const Ground& ground);

// A camera that looks ahead shows much that nobody meant to measure. Beyond the limit of sight
// nothing is expected any more, nor where no two pictures see a place from two sides and the
// nearest has twice the survey's GSD or more. Such cells keep their cause (outline.h).
void LeaveOutBackground(double survey_gsd, Ground* ground);

}  // namespace colmap_seapoint
