#include "colmap_seapoint/io/raster/raster_layout.h"

#include <algorithm>
#include <cmath>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

int NumTiles(int side, int tile_size) { return (side - 1) / tile_size + 1; }

}  // namespace

std::string CheckLayout(const RasterLayout& layout) {
  if (layout.width <= 0 || layout.height <= 0) return "has no pixels";
  if (layout.tile_size < 16 || layout.tile_size % 16 != 0) return "tiles are no multiple of 16";
  if (!(layout.pixel_size > 0) || !std::isfinite(layout.pixel_size)) return "pixels have no size";
  if (!std::isfinite(layout.min_x) || !std::isfinite(layout.max_y)) return "lies nowhere";
  return "";
}

int NumTileColumns(const RasterLayout& layout) { return NumTiles(layout.width, layout.tile_size); }

int NumTileRows(const RasterLayout& layout) { return NumTiles(layout.height, layout.tile_size); }

RasterWindow TileWindow(const RasterLayout& layout, int column, int row) {
  SEAPOINT_CHECK(column >= 0 && column < NumTileColumns(layout));
  SEAPOINT_CHECK(row >= 0 && row < NumTileRows(layout));
  RasterWindow window;
  window.x = column * layout.tile_size;
  window.y = row * layout.tile_size;
  window.width = std::min(layout.tile_size, layout.width - window.x);
  window.height = std::min(layout.tile_size, layout.height - window.y);
  return window;
}

}  // namespace colmap_seapoint
