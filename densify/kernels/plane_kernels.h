// The inner loop of FitSurface. Vector code chosen at run time, the same result from every version.
#pragma once

#include <cstdint>

namespace colmap_seapoint {
namespace plane {

inline constexpr int kMaxRadius = 4;
inline constexpr float kMinSupport = 6;  // samples, for a plane

struct Map {
  const float* value;  // row by row; 0 or less: missing
  int width, height;
};

// As large as the map; 0 where that is missing.
struct Planes {
  float* value;
  float* slope_x;
  float* slope_y;
  float* scatter;    // root mean square of the samples that agree about the plane, itself too
  uint8_t* support;  // how many agree, itself too
};

// Rows begin .. end - 1 of the results. Slopes are times `slope_scale`, a sample.
void FitRows(const Map& map, int begin, int end, int radius, float tolerance, float slope_scale,
             const Planes& planes);

}  // namespace plane
}  // namespace colmap_seapoint
