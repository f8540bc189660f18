// What a map's raster is like: its grid, its bands, and where on the ground it lies.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace colmap_seapoint {

enum class RasterBands {
  kFloat32,  // heights
  kRgba8,    // red green blue alpha; 0 is transparent, 255 opaque, colours are not multiplied by it
  kUint8,    // masks
  kUint16,   // labels
  kUint32,
};

// Rows go down from max_y, columns right from min_x; pixel (c, r) covers [min_x + c * pixel_size,
// min_x + (c + 1) * pixel_size] in x, and likewise downwards in y.
struct RasterLayout {
  RasterBands bands = RasterBands::kFloat32;
  int width = 0;  // pixels
  int height = 0;
  int tile_size = 512;  // pixels, a multiple of 16; the tiles at the right and lower edge are cut
  // The value of pixels that are none. What no tile gives has it too; without one, 0.
  std::optional<double> nodata;
  double min_x = 0, max_y = 0;  // outer edges of the first pixel, units of the ground
  double pixel_size = 1;        // units of the ground
  std::string crs;              // "EPSG:32755" or well-known text; empty: none
  std::string unit;             // of a height, "metre"; empty: arbitrary
  std::vector<std::pair<std::string, std::string>> metadata;  // name and value, kept in the file
};

struct RasterWindow {
  int x = 0, y = 0, width = 0, height = 0;  // pixels
};

// "" or what is wrong with it, as a sentence.
std::string CheckLayout(const RasterLayout& layout);
int NumTileColumns(const RasterLayout& layout);
int NumTileRows(const RasterLayout& layout);
RasterWindow TileWindow(const RasterLayout& layout, int column, int row);

}  // namespace colmap_seapoint
