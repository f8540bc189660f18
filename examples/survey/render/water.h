// What water does to light on its way: attenuation and backscatter by colour and distance, blur,
// caustics and marine snow.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "colmap_seapoint/base/image.h"

namespace colmap_seapoint {

struct Water {
  Eigen::Array3f attenuation;  // 1/metre, red green blue
  Eigen::Array3f veil;         // backscatter of an infinite column, relative to white paper
  Eigen::Array3f open;         // what water shows with nothing behind it, relative to white paper
  double halo_share = 0;       // share of the light that forward scattering spreads out
  double halo_sigma = 0;       // pixels
};

// turbidity: 0 clear ... 1 murky. width: of the pictures, pixels (blur grows with resolution).
Water MakeWater(double turbidity, int width);

// Brightness of the sunlit seabed under waves, mean about 1; another pattern for every picture.
float Caustics(const Eigen::Vector3d& point, double strength, uint64_t picture_seed);

// Spreads `halo_share` of the light over its surroundings, and the lens's own slight blur.
void ScatterForward(const Water& water, FloatImage* linear);

// Bright flakes out of focus between camera and seabed, others in every picture.
void AddMarineSnow(double density, uint64_t picture_seed, FloatImage* linear);

// Shot and read noise on linear light (1 = white), then the sRGB curve.
ColorImage Expose(const FloatImage& linear, double noise, uint64_t picture_seed, int num_threads);

}  // namespace colmap_seapoint
