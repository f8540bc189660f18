#include "colmap_seapoint/water/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace colmap_seapoint {
namespace {

double Linear(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

// The light of every byte, and the borders half a byte above each of them but the last.
struct Table {
  std::array<float, 256> light{};
  std::array<float, 255> border{};
  Table() {
    for (size_t i = 0; i < light.size(); ++i) {
      light[i] = static_cast<float>(Linear(static_cast<double>(i) / 255));
    }
    for (size_t i = 0; i < border.size(); ++i) {
      border[i] = static_cast<float>(Linear((static_cast<double>(i) + 0.5) / 255));
    }
  }
};

const Table& Values() {
  static const Table kTable;
  return kTable;
}

}  // namespace

float LinearFromSrgb(uint8_t value) { return Values().light[value]; }

uint8_t SrgbFromLinear(float linear) {
  if (std::isnan(linear)) return 0;
  const auto& border = Values().border;
  return static_cast<uint8_t>(std::upper_bound(border.begin(), border.end(), linear) -
                              border.begin());
}

}  // namespace colmap_seapoint
