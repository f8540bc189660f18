#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"

namespace colmap_seapoint::sampling {
namespace {

float FromScreen(double value) {
  const double share = value / 255;
  return static_cast<float>(share <= 0.04045 ? share / 12.92
                                             : std::pow((share + 0.055) / 1.055, 2.4));
}

float ToScreen(double light) {
  return static_cast<float>(
      255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055));
}

}  // namespace

LightTables::LightTables() {
  for (size_t i = 0; i < light.size(); ++i) {
    light[i] = FromScreen(std::min(255.0, static_cast<double>(i)));
  }
  for (size_t i = 0; i < screen.size(); ++i) {
    screen[i] = ToScreen(std::min(1.0, static_cast<double>(i) / kScreenSteps));
  }
}

const LightTables kLightTables;

}  // namespace colmap_seapoint::sampling
