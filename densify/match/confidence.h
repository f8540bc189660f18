// How sure a point is (ours): from how far its disparity may be off to the probability that it lies
// on the surface.
#pragma once

#include "densify/match/pair_geometry.h"
#include "densify/match/surface_fit.h"

namespace colmap_seapoint {

// Sets surface->confidence, 0..1: the probability that the point lies within two ground sampling
// distances (of its own range: range / mean focal length of camera 1) of the surface. Measured on
// worlds with exact truth and poses; an error of the poses is not in it. The same result for any
// number of threads. Cost: about 20 ns a sample.
void AssessConfidence(const PairGeometry& geometry, int num_threads, PartialSurface* surface);

}  // namespace colmap_seapoint
