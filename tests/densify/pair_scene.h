// Two exact pictures of an exact world, and what a cloud made of them is worth.
#pragma once

#include <cstddef>

#include "densify/densify_pair.h"
#include "tests/synthetic/world.h"

namespace colmap_seapoint {

struct PairScene {
  World world;
  Viewpoint view1, view2;
  Picture picture1;
  GrayImage luma2;

  PairScene(const World& the_world, const Viewpoint& viewpoint1, const Viewpoint& viewpoint2);
  // Exact correspondences of `num_seeds` random pixels that both pictures see.
  PairInput Input(const PartialDensificationOptions& options, int num_seeds = 300) const;
  // Ground sampling distance at a depth, world units.
  double Gsd(double depth) const { return depth / view1.camera.MeanFocal(); }
};

// Shares of the cloud's points within half, one and two GSD of the true surface.
struct Accuracy {
  double half_gsd = 0, one_gsd = 0, two_gsd = 0;
};
Accuracy MeasureAccuracy(const PairScene& scene, const PartialCloud& cloud, double gsd);

// Of the pixels of picture 1 whose surface picture 2 sees too (a grid of every fourth one): share
// with a point within two pixels that lies within two GSD of the surface.
double MeasureCoverage(const PairScene& scene, const PartialCloud& cloud, double gsd);

}  // namespace colmap_seapoint
