// Maps as Cloud-Optimised GeoTIFFs, written tile by tile: memory does not grow with the map.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/io/raster/raster_layout.h"

namespace colmap_seapoint {

// TagLab and other programs on Qt open no picture with a longer side.
inline constexpr int kMaxBlockSide = 32767;

struct RasterWriterOptions {
  int max_block_side = kMaxBlockSide;  // larger rasters are written in blocks as well, pixels
};

// Takes the tiles in any order into a temporary file, and makes of them, in Finish():
//   map.tif      a Cloud-Optimised GeoTIFF (DEFLATE, overviews down to 512 pixels, BigTIFF where it
//                must be): the values of heights and colours are averaged for overviews, labels and
//                masks are not
//   map.tfw      a world file, where there is no reference system
//   map_blocks/  the same in blocks of at most max_block_side, and map.vrt, which joins them, where
//                the raster has a longer side
// The same bytes for any order of tiles; each file appears whole or not at all. Several rasters may
// be finished at once, each on one thread. Replaces what has the names of RasterFiles(), which the
// caller must have claimed (io/outputs/output_folder.h). Throws Error (file, finding, remedy): a
// reference system that PROJ does not know (at once), a full disk, a GDAL without the drivers.
//
// Cost: the raster's bytes on the disk twice, compressed; memory 128 MB of GDAL's cache, shared by
// all writers.
class RasterWriter {
 public:
  RasterWriter(const std::filesystem::path& path, const RasterLayout& layout,
               const RasterWriterOptions& options = {});
  ~RasterWriter();  // without Finish(), nothing is left
  RasterWriter(const RasterWriter&) = delete;
  RasterWriter& operator=(const RasterWriter&) = delete;

  // `tile` is of TileWindow()'s size and of the type and channels of the layout's bands; RGBA has 4
  // channels, interleaved. May be called from several threads. A tile that is never written has no
  // pixels that are any.
  void WriteTile(int column, int row, const Image<float>& tile);
  void WriteTile(int column, int row, const Image<uint8_t>& tile);
  void WriteTile(int column, int row, const Image<uint16_t>& tile);
  void WriteTile(int column, int row, const Image<uint32_t>& tile);
  void Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The names of all files that a writer of `name` ("orthomosaic.tif") makes, relative to its folder.
std::vector<std::string> RasterFiles(const std::string& name, const RasterLayout& layout,
                                     const RasterWriterOptions& options = {});

}  // namespace colmap_seapoint
