// Random numbers that depend only on what they are for (a counter-based hash), and gradient noise
// on regular grids. Nothing here has a state: any thread may compute any part in any order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace colmap_seapoint {

inline uint64_t Hash(uint64_t x) {  // splitmix64
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

inline uint64_t Hash(uint64_t seed, int64_t a, int64_t b = 0) {
  return Hash(Hash(seed ^ static_cast<uint64_t>(a) * 0xd6e8feb86659fd93ULL) ^
              static_cast<uint64_t>(b) * 0xa0761d6478bd642fULL);
}

// A number in [0, 1) from a hash.
inline double Uniform(uint64_t hash) { return static_cast<double>(hash >> 11) * 0x1p-53; }

// Mean 0, standard deviation 1, never beyond 3: the sum of three uniform numbers.
inline float Bell(uint64_t hash) {
  constexpr uint64_t kMask = (1u << 21) - 1;
  const uint64_t sum = (hash & kMask) + ((hash >> 21) & kMask) + ((hash >> 42) & kMask);
  return 2.0f * (static_cast<float>(sum) / static_cast<float>(kMask) - 1.5f);
}

// Node (i, j) lies at ((ix0 + i) * step, (iy0 + j) * step), metres. A node has the same value in
// every grid that holds it.
struct GridSpec {
  int64_t ix0 = 0;
  int64_t iy0 = 0;
  int nx = 0;
  int ny = 0;
  double step = 1;

  double X(int i) const { return static_cast<double>(ix0 + i) * step; }
  double Y(int j) const { return static_cast<double>(iy0 + j) * step; }
  size_t Size() const { return static_cast<size_t>(nx) * static_cast<size_t>(ny); }
  size_t Index(int i, int j) const {
    return static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i);
  }
  // Of the outermost nodes, metres.
  double MinX() const { return X(0); }
  double MinY() const { return Y(0); }
  double MaxX() const { return X(nx - 1); }
  double MaxY() const { return Y(ny - 1); }
  bool Contains(double x, double y) const {
    return x >= MinX() && y >= MinY() && x <= MaxX() && y <= MaxY();
  }
};

using Field = std::vector<float>;  // row by row, grid.Size() values

// Octaves of gradient noise from the longest down to the shortest wavelength (metres).
struct Fbm {
  double longest = 1;
  double shortest = 0.1;
  float persistence = 0.5f;  // amplitude of an octave over that of the octave before
};

// One octave with values in about [-0.7, 0.7], times `amplitude`, added to `field`.
void AddNoise(const GridSpec& grid, double wavelength, float amplitude, uint64_t seed,
              Field* field);

// Noise with mean 0 and standard deviation 1.
Field MakeFbm(const GridSpec& grid, const Fbm& fbm, uint64_t seed);

// One octave at one place (slow).
float NoiseAt(double x, double y, double wavelength, uint64_t seed);

inline float SmoothStep(float low, float high, float x) {
  float t = (x - low) / (high - low);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return t * t * (3 - 2 * t);
}

inline float Mix(float a, float b, float weight) { return a + weight * (b - a); }

}  // namespace colmap_seapoint
