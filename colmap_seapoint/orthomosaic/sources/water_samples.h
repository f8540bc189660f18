// What the water does to a map's sources: measured by them, and taken out of them.
#pragma once

#include <vector>

#include "colmap_seapoint/orthomosaic/sources/source_blocks.h"
#include "colmap_seapoint/water/restoration.h"

namespace colmap_seapoint {

// Blocks as two pictures or more show them (block_colors.h), some ten thousand from all over the
// map, for EstimateWater().
std::vector<WaterSample> CollectWaterSamples(const Relief& relief,
                                             const std::vector<MapView>& views,
                                             const SourceBlocks& sources);

// The farthest that a source's camera is from its block; 0 without sources.
double MaxRange(const Relief& relief, const std::vector<MapView>& views,
                const SourceBlocks& sources);

// The sources' colours as the surface would show them without the water.
void RestoreSources(const Relief& relief, const std::vector<MapView>& views,
                    const Restoration& restoration, SourceBlocks* sources);

}  // namespace colmap_seapoint
