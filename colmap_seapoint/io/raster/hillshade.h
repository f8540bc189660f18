// How a relief looks in slanting light.
#pragma once

#include <cstdint>

namespace colmap_seapoint {

struct HillshadeLight {
  double azimuth_deg = 315;  // where the light comes from, clockwise from up in the map
  double elevation_deg = 45;
};

// One row of a shaded relief, from its heights (as far up as pixel_size is across) and those of the
// rows above and below (nullptr at the map's edge). Slopes are Horn's (1981): differences of the
// three columns and rows around the pixel, the middle ones twice. A neighbour that is missing (NaN)
// is taken to lie on the plane through the others: as far above the pixel as the opposite one
// lies below it; where that is missing too, level with the pixel in its row or column.
// `gray_alpha`: 2 * width bytes: 1..255 and 255, or 0 and 0 where the pixel itself is missing.
void ShadeRow(const float* above, const float* row, const float* below, int width,
              double pixel_size, const HillshadeLight& light, uint8_t* gray_alpha);

}  // namespace colmap_seapoint
