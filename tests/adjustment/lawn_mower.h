// Surveys of a thousand pictures that are known exactly, and what a mapper makes of them that had
// the lens wrong: the ground bends, and the residuals hardly tell.
#pragma once

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// Strips there and back, 2 units above ground with some relief, through ExactLens(); about so many
// points a picture.
SparseModel LawnMower(int num_strips, int pictures_a_strip, int points_a_picture);

// Every picture turned and lifted as if the ground were a bowl, `depth` units deep at the ends of
// the survey, the points with them; and focal length and k1 off by one per cent.
SparseModel Bent(SparseModel model, double depth);

// Root mean square distance of the camera centres after the best similarity, units.
double CentersRms(const SparseModel& model, const SparseModel& truth);

}  // namespace colmap_seapoint
