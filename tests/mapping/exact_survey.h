// A survey whose lens, poses and points are known exactly, and what a mapper makes of it.
#pragma once

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// OPENCV, 1000 x 750 pixels, focal length 900, every parameter off its default.
Camera ExactLens();

// Where the picture sees point `id`, as an observation of both; nothing where it does not.
void Observe(const Camera& camera, uint64_t id, PosedImage* image, SparsePoint* point);

// Two strips over ground with some relief, flown there and back, as every picture saw it exactly:
// img1.jpg, img2.jpg ... with ids from 1.
SparseModel ExactSurvey(const Camera& camera, int pictures_a_strip);

// The survey as a mapper leaves it that knew neither distortion nor principal point.
SparseModel Disturbed(SparseModel model);

// The largest distance, in pixels, between where two lenses put the same directions.
double LargestDifference(const Camera& a, const Camera& b);

}  // namespace colmap_seapoint
