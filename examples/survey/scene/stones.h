// Boulders, stones and pebbles: one, or none, at a random place of every square of a lattice, in
// three sizes.
#pragma once

#include <cstdint>
#include <vector>

#include "examples/survey/scene/noise.h"

namespace colmap_seapoint {

struct StoneLayer {
  Field height;  // metres above the ground; 0 where there is none
  Field tone;    // brightness factor of the stone on top; 0 where there is none
};

// `roughness`: noise (deviation 1) that gives the stones their irregular outline.
StoneLayer MakeStones(const GridSpec& grid, const Field& roughness, uint64_t seed);

// Barnacles, holes, fragments: flat spots of millimetres; a brightness factor, 0 between them.
Field MakeSpots(const GridSpec& grid, const Field& roughness, uint64_t seed);

}  // namespace colmap_seapoint
