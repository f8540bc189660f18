// What each picture shows of the blocks that it may colour.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "colmap_seapoint/orthomosaic/ground/map_view.h"
#include "colmap_seapoint/orthomosaic/sources/map_pictures.h"
#include "colmap_seapoint/orthomosaic/sources/source_blocks.h"

namespace colmap_seapoint {

// Fills in mean colour and sharpness of all sources, each picture read once; takes out sources that
// are masked there, and all of a picture that cannot be read or has other proportions than its
// camera: those are returned. Then sharper pictures become cheaper, against the sharpest of a
// block, and the sources of a block are sorted anew. About 2 microseconds a source. `progress` is
// told how many pictures are done, from one thread at a time.
std::vector<size_t> LookAtSources(const Relief& relief, const std::vector<MapView>& views,
                                  int num_threads, const std::function<void(int64_t)>& progress,
                                  MapPictures* pictures, SourceBlocks* sources);

}  // namespace colmap_seapoint
