// Surveys through a known lens whose observations err by a known noise.
#pragma once

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// ExactSurvey() of the lens with normal noise of each coordinate, pixels.
SparseModel NoisySurvey(const Camera& lens, int pictures_a_strip, double sigma, unsigned seed = 1);

// 1000 x 750 pixels; parameters in COLMAP's order.
Camera LensOf(CameraModel model, const std::vector<double>& params);

}  // namespace colmap_seapoint
