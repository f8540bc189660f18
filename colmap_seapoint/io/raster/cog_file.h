// GeoTIFFs that are whole: with overviews, and in the order that readers over a network want. For
// this room only.
#pragma once

#include <filesystem>
#include <vector>

#include "colmap_seapoint/io/raster/gdal_session.h"
#include "colmap_seapoint/io/raster/raster_layout.h"

namespace colmap_seapoint {

// How a temporary file of the layout is made: tiled, compressed a little.
GdalStrings ScratchOptions(const RasterLayout& layout);

// Gives `scratch`, a GeoTIFF of the layout in `scratch_file` that can be written, its overviews,
// and copies it to `path` as a Cloud-Optimised GeoTIFF. Atomic. Throws Error.
void WriteCog(GDALDatasetH scratch, const AtomicPath& scratch_file,
              const std::filesystem::path& path, const RasterLayout& layout);

// The raster cut into equal blocks of no longer side than max_side, in rows.
std::vector<RasterWindow> Blocks(const RasterLayout& layout, int max_side);
// Beside map.tif: "map_blocks/0_1.tif" of the first row's second block, and "map.vrt".
std::vector<std::filesystem::path> BlockPaths(const std::filesystem::path& path,
                                              const RasterLayout& layout, int max_side);
std::filesystem::path BlockIndexPath(const std::filesystem::path& path);

// Writes `scratch` as these blocks, each a Cloud-Optimised GeoTIFF, and the file that joins them.
void WriteBlocks(GDALDatasetH scratch, const std::filesystem::path& path,
                 const RasterLayout& layout, int max_side);

}  // namespace colmap_seapoint
