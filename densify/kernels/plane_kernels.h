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

// Rows begin .. end - 1 of the results, which are as large as the map. Slopes are times
// `slope_scale`, a sample.
void FitRows(const Map& map, int begin, int end, int radius, float tolerance, float slope_scale,
             float* value, float* slope_x, float* slope_y, uint8_t* support);

}  // namespace plane
}  // namespace colmap_seapoint
