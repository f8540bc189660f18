#include "tests/synthetic/noise_texture.h"

#include <cmath>

namespace colmap_seapoint {

namespace {

// Value of a lattice point, -1..1.
double LatticeValue(int64_t x, int64_t y, int64_t z, uint32_t seed) {
  uint64_t hash = static_cast<uint64_t>(x) * 0x9E3779B97F4A7C15u ^
                  static_cast<uint64_t>(y) * 0xC2B2AE3D27D4EB4Fu ^
                  static_cast<uint64_t>(z) * 0x165667B19E3779F9u ^ seed * 0x27D4EB2F165667C5u;
  hash ^= hash >> 29;
  hash *= 0xBF58476D1CE4E5B9u;
  hash ^= hash >> 32;
  hash *= 0x94D049BB133111EBu;
  hash ^= hash >> 31;
  return static_cast<double>(hash >> 11) * 0x1p-52 - 1;
}

double ValueNoise(const Eigen::Vector3d& p, uint32_t seed) {
  int64_t base[3];
  double weight[3];
  for (int i = 0; i < 3; ++i) {
    const double floor = std::floor(p[i]);
    base[i] = static_cast<int64_t>(floor);
    const double t = p[i] - floor;
    weight[i] = t * t * t * (t * (6 * t - 15) + 10);
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
    sum += (dx ? weight[0] : 1 - weight[0]) * (dy ? weight[1] : 1 - weight[1]) *
           (dz ? weight[2] : 1 - weight[2]) *
           LatticeValue(base[0] + dx, base[1] + dy, base[2] + dz, seed);
  }
  return sum;
}

}  // namespace

double NoiseTexture::At(const Eigen::Vector3d& point) const {
  double sum = 0, amplitude = 1, spacing = spacing_;
  for (int octave = 0; octave < num_octaves_; ++octave) {
    sum += amplitude * ValueNoise(point / spacing, seed_ + static_cast<uint32_t>(octave));
    amplitude *= 0.7;
    spacing *= 0.5;
  }
  return sum;
}

}  // namespace colmap_seapoint
