#include "colmap_seapoint/orthomosaic/sources/picture_sample.h"

namespace colmap_seapoint {
namespace {

constexpr int kScreenSteps = 4096;

float FromScreen(double value) {
  const double share = value / 255;
  return static_cast<float>(share <= 0.04045 ? share / 12.92
                                             : std::pow((share + 0.055) / 1.055, 2.4));
}

float ToScreen(double light) {
  return static_cast<float>(
      255 * (light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055));
}

struct Tables {
  std::array<float, 257> light;
  std::array<float, kScreenSteps + 2> screen;
  Tables() {
    for (size_t i = 0; i < light.size(); ++i) {
      light[i] = FromScreen(std::min(255.0, static_cast<double>(i)));
    }
    for (size_t i = 0; i < screen.size(); ++i) {
      screen[i] = ToScreen(std::min(1.0, static_cast<double>(i) / kScreenSteps));
    }
  }
};

const Tables& TheTables() {
  static const Tables tables;
  return tables;
}

}  // namespace

float LightOf(float value) {
  const std::array<float, 257>& table = TheTables().light;
  const auto at = static_cast<size_t>(value);
  return table[at] + (value - static_cast<float>(at)) * (table[at + 1] - table[at]);
}

uint8_t ScreenOf(float light) {
  const auto& table = TheTables().screen;
  const float place = std::clamp(light, 0.0f, 1.0f) * kScreenSteps;
  const auto at = static_cast<size_t>(place);
  const float value = table[at] + (place - static_cast<float>(at)) * (table[at + 1] - table[at]);
  return static_cast<uint8_t>(value + 0.5f);
}

}  // namespace colmap_seapoint
