// A continuous random function of space, so that a picture of a textured surface can be computed
// exactly at any position: no resampling, no resolution.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace colmap_seapoint {

// Octaves of smooth value noise on a cubic lattice: `spacing` (world units) between the lattice
// points of the first octave, half as much and 0.7 times the amplitude in every following one.
class NoiseTexture {
 public:
  NoiseTexture(uint32_t seed, double spacing, int num_octaves)
      : seed_(seed), spacing_(spacing), num_octaves_(num_octaves) {}

  // Mean about 0, almost always within -1..1.
  double At(const Eigen::Vector3d& point) const;

 private:
  uint32_t seed_;
  double spacing_;
  int num_octaves_;
};

}  // namespace colmap_seapoint
