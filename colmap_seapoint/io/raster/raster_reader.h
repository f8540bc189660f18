// A map that RasterWriter has finished, read in strips or as a whole, smaller if asked for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/io/raster/raster_layout.h"

namespace colmap_seapoint {

class RasterReader {
 public:
  // Opens it at full size, or its first overview of which no side is longer than max_side (the
  // smallest, when all are); 0: at full size. Throws Error when GDAL cannot read the file as a
  // GeoTIFF.
  explicit RasterReader(const std::filesystem::path& path, int max_side = 0);
  ~RasterReader();
  RasterReader(const RasterReader&) = delete;
  RasterReader& operator=(const RasterReader&) = delete;

  // Of what was opened: of an overview the size, and the size of a pixel, are its own. `bands` is
  // by the type of the first band and their number; crs is well-known text.
  const RasterLayout& Layout() const;

  // Rows first .. first + count - 1 of the first band; NaN where a pixel is none. Throws Error.
  FloatImage ReadHeights(int first, int count) const;
  // Pixels (x, y) ... of all bands, as they are in the file; what of them lies outside of the
  // raster stays as it is in `window`, which is of the type and channels of the bands. Throws
  // Error.
  void ReadWindow(int x, int y, Image<float>* window) const;
  void ReadWindow(int x, int y, Image<uint8_t>* window) const;
  void ReadWindow(int x, int y, Image<uint16_t>* window) const;
  void ReadWindow(int x, int y, Image<uint32_t>* window) const;
  // All bands of an RGBA raster, averaged to this size. Throws Error.
  Image<uint8_t> ReadColors(int width, int height) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace colmap_seapoint
