// What a survey is dived around: a boulder on the seabed, a statue.
#pragma once

#include <cstdint>

#include "examples/survey/scene/height_field.h"
#include "examples/survey/scene/sheet.h"

namespace colmap_seapoint {

struct LandmarkOptions {
  uint64_t seed = 1;
  double radius = 0.4;   // metres
  double height = 1.6;   // metres above the ground in the origin
  double relief = 1;     // factor on its roughness
  double cell = 0.0017;  // metres between nodes, about
};

// The same ground with a rough boulder in the origin of its frame.
HeightField WithBoulder(const HeightField& ground, const LandmarkOptions& options);

// A statue in the origin, on a plinth whose foot is sunk into the ground: hips, waist, shoulders
// that overhang it, neck, head. No two of its sides are alike. `ground_height`: z of the origin.
Sheet MakeStatue(const LandmarkOptions& options, double ground_height);

}  // namespace colmap_seapoint
