#include "densify/overlap/packed_footprint.h"

#include <algorithm>
#include <cmath>

namespace colmap_seapoint {

namespace {

constexpr float kUnitsPerPatch = 32;  // along the side of the smallest one
constexpr float kMaxUnits = 1 << 22;  // of the radius: as finely as its floats

// The unit that the numbers of a footprint are counted in; world units.
float UnitOf(const CloudFootprint& footprint) {
  float smallest = footprint.radius;
  for (const SurfacePatch& patch : footprint.patches) smallest = std::min(smallest, patch.size);
  const float unit = std::max(smallest / kUnitsPerPatch, footprint.radius / kMaxUnits);
  return unit > 0 ? unit : 1;
}

}  // namespace

void CloudFootprint::UpdateSphere() {
  center.setZero();
  radius = 0;
  if (patches.empty()) return;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SurfacePatch& patch : patches) sum += patch.center.cast<double>();
  center = (sum / static_cast<double>(patches.size())).cast<float>();
  for (const SurfacePatch& patch : patches) {
    radius = std::max(radius, (patch.center - center).norm() + patch.size);
  }
}

PackedFootprint::PackedFootprint(const CloudFootprint& footprint)
    : center_(footprint.center),
      radius_(footprint.radius),
      unit_(UnitOf(footprint)),
      num_patches_(footprint.patches.size()) {
  nibbles_.reserve(3 * num_patches_);
  Line line;
  size_t at = 0;
  for (const SurfacePatch& patch : footprint.patches) {
    const Eigen::Vector3f place = (patch.center - center_) / unit_;
    Number value;
    for (int k = 0; k < 3; ++k) value[k] = std::lround(place[k]);
    value[3] = std::max(1L, std::lround(patch.size / unit_));
    for (int k = 0; k < 4; ++k) WriteNumber(value[k] - line.Predict(k), &at);
    line.Append(value);
  }
  nibbles_.shrink_to_fit();
}

void PackedFootprint::WriteNumber(int64_t number, size_t* at) {
  // Small numbers of either sign become small codes.
  uint64_t code = (static_cast<uint64_t>(number) << 1) ^ static_cast<uint64_t>(number >> 63);
  do {
    const auto nibble = static_cast<uint8_t>((code & 7) | (code > 7 ? 8 : 0));
    code >>= 3;
    if (*at % 2 == 0) nibbles_.push_back(0);
    nibbles_.back() |= static_cast<uint8_t>(nibble << (4 * (*at % 2)));
    ++*at;
  } while (code > 0);
}

}  // namespace colmap_seapoint
