// Restore() for many pixels: by tables.
#pragma once

#include <array>
#include <vector>

#include "colmap_seapoint/water/water_model.h"

namespace colmap_seapoint {

class Restoration {
 public:
  // Ranges from 0 to `max_range` (positive, the model's unit) are tabulated; those beyond cost as
  // much as Restore().
  Restoration(const WaterModel& water, float max_range);

  // As Restore(), within a thousandth of it. About 10 ns.
  std::array<float, 3> operator()(const std::array<float, 3>& rgb, float range,
                                  float axis_cosine) const;

 private:
  struct Entry {
    std::array<float, 3> veil, gain;  // gain: the white balance too
  };

  WaterModel water_;
  float max_range_, entries_a_unit_;
  std::vector<Entry> entries_;
  std::vector<float> inverse_falloff_;  // by the cosine
};

}  // namespace colmap_seapoint
