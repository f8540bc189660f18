// What a map leaves for the one that continues it when pictures come in: a survey that grows has
// what is new drawn alone (ours).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "colmap_seapoint/orthomosaic/ground/map_frame.h"
#include "colmap_seapoint/orthomosaic/ground/map_grid.h"
#include "colmap_seapoint/orthomosaic/sources/exposure.h"
#include "colmap_seapoint/orthomosaic/sources/source_blocks.h"

namespace colmap_seapoint {

// Frame, pixel size, what all colours are balanced to, and which picture colours what: they stay as
// the first map had them, for what is drawn later to fit onto it.
struct MapMemory {
  MapFrame frame;
  MapGrid grid;
  double gsd = 0;
  double ground = 0;          // median height
  int cell_size = 1;          // the usual one, pixels
  size_t first_pictures = 0;  // that the first map was made of
  uint64_t num_points = 0;    // of the cloud: its first ones
  std::vector<float> mean;    // BlockRelief
  float lowest = 0, highest = 0;
  SourceBlocks sources;
  Exposure exposure{{}, {}, {}};  // of all pictures, the model's first
};

}  // namespace colmap_seapoint
