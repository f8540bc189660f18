// One tile of the map, coloured: a true orthographic view.
#pragma once

#include <vector>

#include "colmap_seapoint/orthomosaic/ground/map_tile.h"
#include "colmap_seapoint/orthomosaic/ground/map_view.h"
#include "colmap_seapoint/orthomosaic/sources/exposure.h"
#include "colmap_seapoint/orthomosaic/sources/map_pictures.h"
#include "colmap_seapoint/orthomosaic/sources/source_blocks.h"
#include "colmap_seapoint/water/restoration.h"

namespace colmap_seapoint {

struct MapScene {  // all that a tile is drawn from
  const Relief& relief;
  const std::vector<MapView>& views;
  const SourceBlocks& sources;
  const Exposure& exposure;
  const Restoration* restoration = nullptr;  // before the exposure; nullptr: colours as they are
};

// Each pixel's place on the surface is looked up in the picture that its block has chosen, between
// the pixels of that, in linear light and balanced. Where the chosen pictures of neighbouring
// blocks differ they are blended over a few pixels midway between the blocks' centres. A picture
// that does not show the place (outside of it, masked, hidden by the surface) does not count; where
// none of the chosen ones shows it, the cheapest of the block's other sources does. Nothing is
// coloured otherwise. The tile must have a surface. About 0.15 microseconds a pixel.
MapTile RenderTile(const MapScene& scene, int tile_idx, MapPictures* pictures);

}  // namespace colmap_seapoint
