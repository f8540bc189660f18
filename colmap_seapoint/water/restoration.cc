#include "colmap_seapoint/water/restoration.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr int kRanges = 2048;
constexpr int kCosines = 1024;
constexpr float kLeastCosine = 0.1f;  // below, as exactly there

}  // namespace

Restoration::Restoration(const WaterModel& water, float max_range)
    : water_(water), max_range_(max_range), entries_a_unit_(kRanges / max_range) {
  SEAPOINT_CHECK(std::isfinite(max_range) && max_range > 0);
  for (int i = 0; i <= kRanges + 1; ++i) {
    const double z = i / static_cast<double>(entries_a_unit_);
    const Eigen::Array3d veil = water.veil * (1 - (-water.veil_rate * z).exp());
    const Eigen::Array3d gain =
        (water.attenuation * z).exp().min(water.max_gain.max(1)) * water.white;
    Entry& entry = entries_.emplace_back();
    for (size_t c = 0; c < 3; ++c) {
      entry.veil[c] = static_cast<float>(veil[static_cast<Eigen::Index>(c)]);
      entry.gain[c] = static_cast<float>(gain[static_cast<Eigen::Index>(c)]);
    }
  }
  for (int i = 0; i <= kCosines + 1; ++i) {
    const double cosine = std::max(static_cast<double>(i) / kCosines, double{kLeastCosine});
    inverse_falloff_.push_back(static_cast<float>(std::pow(cosine, -water.falloff)));
  }
}

std::array<float, 3> Restoration::operator()(const std::array<float, 3>& rgb, float range,
                                             float axis_cosine) const {
  if (!(range >= 0 && range <= max_range_) || !(axis_cosine >= kLeastCosine && axis_cosine <= 1)) {
    const Eigen::Array3f exact = Restore(water_, {rgb[0], rgb[1], rgb[2]}, range, axis_cosine);
    return {exact[0], exact[1], exact[2]};
  }
  const float cosine_place = axis_cosine * kCosines, place = range * entries_a_unit_;
  const auto cosine_at = static_cast<size_t>(cosine_place), at = static_cast<size_t>(place);
  const float cosine_rest = cosine_place - static_cast<float>(cosine_at);
  const float rest = place - static_cast<float>(at);
  const float factor =
      inverse_falloff_[cosine_at] +
      cosine_rest * (inverse_falloff_[cosine_at + 1] - inverse_falloff_[cosine_at]);
  const Entry &a = entries_[at], &b = entries_[at + 1];
  std::array<float, 3> result;
  for (size_t c = 0; c < 3; ++c) {
    const float veil = a.veil[c] + rest * (b.veil[c] - a.veil[c]);
    const float gain = a.gain[c] + rest * (b.gain[c] - a.gain[c]);
    result[c] = std::max((rgb[c] * factor - veil) * gain, 0.0f);
  }
  return result;
}

}  // namespace colmap_seapoint
