#include "colmap_seapoint/io/raster/hillshade.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace colmap_seapoint {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

// A pixel and its eight neighbours, at [row][column].
struct Neighbourhood {
  float z[3][3];

  // The plane through what is there: first up, down, left and right, then the corners.
  void Complete() {
    const float centre = z[1][1];
    const auto mirror = [&](int r, int c) {
      if (std::isfinite(z[r][c])) return z[r][c];
      return std::isfinite(z[2 - r][2 - c]) ? 2 * centre - z[2 - r][2 - c] : kMissing;
    };
    const auto or_else = [](float value, float other) {
      return std::isfinite(value) ? value : other;
    };
    const float up = or_else(mirror(0, 1), centre), down = or_else(mirror(2, 1), centre);
    const float left = or_else(mirror(1, 0), centre), right = or_else(mirror(1, 2), centre);
    const float completed[3][3] = {
        {or_else(mirror(0, 0), up + left - centre), up, or_else(mirror(0, 2), up + right - centre)},
        {left, centre, right},
        {or_else(mirror(2, 0), down + left - centre), down,
         or_else(mirror(2, 2), down + right - centre)}};
    std::copy(&completed[0][0], &completed[0][0] + 9, &z[0][0]);
  }
  // Of the height, a pixel to the right and a pixel up.
  double SlopeRight() const {
    return ((z[0][2] + 2.0 * z[1][2] + z[2][2]) - (z[0][0] + 2.0 * z[1][0] + z[2][0])) / 8;
  }
  double SlopeUp() const {
    return ((z[0][0] + 2.0 * z[0][1] + z[0][2]) - (z[2][0] + 2.0 * z[2][1] + z[2][2])) / 8;
  }
};

}  // namespace

void ShadeRow(const float* above, const float* row, const float* below, int width,
              double pixel_size, const HillshadeLight& light, uint8_t* gray_alpha) {
  const double azimuth = light.azimuth_deg * kPi / 180, up = light.elevation_deg * kPi / 180;
  const double to_right = std::sin(azimuth) * std::cos(up);
  const double to_top = std::cos(azimuth) * std::cos(up);
  const float* const rows[3] = {above, row, below};
  for (int x = 0; x < width; ++x, gray_alpha += 2) {
    gray_alpha[0] = gray_alpha[1] = 0;
    if (!std::isfinite(row[x])) continue;
    Neighbourhood around;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        const int at = x + c - 1;
        const bool is_inside = rows[r] != nullptr && at >= 0 && at < width;
        around.z[r][c] = is_inside ? rows[r][at] : kMissing;
      }
    }
    around.Complete();
    const double right = around.SlopeRight() / pixel_size, top = around.SlopeUp() / pixel_size;
    const double cosine =
        (std::sin(up) - to_right * right - to_top * top) / std::sqrt(1 + right * right + top * top);
    gray_alpha[0] = static_cast<uint8_t>(std::lround(1 + 254 * std::clamp(cosine, 0.0, 1.0)));
    gray_alpha[1] = 255;
  }
}

}  // namespace colmap_seapoint
