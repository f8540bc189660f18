// Where a picture lies on the ground, in the six lines that every program of maps reads beside it.
#pragma once

#include <filesystem>

#include "colmap_seapoint/io/raster/raster_layout.h"

namespace colmap_seapoint {

// map.tif -> map.tfw, map.png -> map.pgw, map.jpg -> map.jgw.
std::filesystem::path WorldFileOf(const std::filesystem::path& picture);
// Atomic.
void WriteWorldFile(const std::filesystem::path& picture, const RasterLayout& layout);

}  // namespace colmap_seapoint
