#include "colmap_seapoint/water/water_model.h"

#include <cmath>
#include <cstdio>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/water/srgb.h"

namespace colmap_seapoint {

Eigen::Array3f Restore(const WaterModel& water, const Eigen::Array3f& rgb, float range,
                       float axis_cosine) {
  const double z = range > 0 ? range : 0;
  const double falloff = axis_cosine > 0 ? std::pow(axis_cosine, water.falloff) : 1;
  const Eigen::Array3d veil = water.veil * (1 - (-water.veil_rate * z).exp());
  const Eigen::Array3d gain = (water.attenuation * z).exp().min(water.max_gain.max(1));
  return ((rgb.cast<double>() / falloff - veil) * gain * water.white).max(0).cast<float>();
}

std::array<uint8_t, 3> RestorePixel(const WaterModel& water, const std::array<uint8_t, 3>& rgb,
                                    float range, float axis_cosine) {
  const Eigen::Array3f light(LinearFromSrgb(rgb[0]), LinearFromSrgb(rgb[1]),
                             LinearFromSrgb(rgb[2]));
  const Eigen::Array3f restored = Restore(water, light, range, axis_cosine);
  return {SrgbFromLinear(restored[0]), SrgbFromLinear(restored[1]), SrgbFromLinear(restored[2])};
}

std::string WaterText(const WaterModel& water) {
  switch (water.state) {
    case WaterState::kDetermined: {
      char text[160];
      std::snprintf(text, sizeof(text), "attenuation %.3f %.3f %.3f, veil %.3f %.3f %.3f",
                    water.attenuation[0], water.attenuation[1], water.attenuation[2], water.veil[0],
                    water.veil[1], water.veil[2]);
      return text;
    }
    case WaterState::kTooFewPlaces:
      return "the water is not known: too few places are seen from two ranges";
    case WaterState::kOneRange:
      return "the water is not known: every place is seen from about one range";
    case WaterState::kUncertain:
      return "the water is not known: the colours contradict one another too much";
  }
  SEAPOINT_CHECK(false);
  return "";
}

}  // namespace colmap_seapoint
