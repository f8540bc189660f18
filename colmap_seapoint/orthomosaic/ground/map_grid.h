// The pixels of a map, and the tiles that it is made in.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace colmap_seapoint {

struct MapGrid {
  double left = 0, top = 0;  // outer corner of the first pixel, in the map's frame
  double pixel_size = 1;     // in its unit
  int width = 0, height = 0;
  int tile_size = 1024;  // pixels, a multiple of 16; the last tiles of a row or column are smaller

  struct Box {
    int x = 0, y = 0, width = 0, height = 0;
  };

  int NumTilesX() const { return (width + tile_size - 1) / tile_size; }
  int NumTilesY() const { return (height + tile_size - 1) / tile_size; }
  int NumTiles() const { return NumTilesX() * NumTilesY(); }
  Box Tile(int tile_idx) const;
  // Column and row, with fractions, of a place of the map; a pixel's centre is at (0.5, 0.5).
  Eigen::Vector2d PixelOf(double x, double y) const {
    return {(x - left) / pixel_size, (top - y) / pixel_size};
  }
  Eigen::Vector2d PlaceOf(double column, double row) const {
    return {left + column * pixel_size, top - row * pixel_size};
  }
};

inline constexpr int kMaxMapSide = 100000;  // pixels

// The grid over a sample of the cloud, at least one point, in the map's frame: all but a thousandth
// of it at either end of each axis, and a fiftieth of that extent more. Points far outside of the
// rest do not make the map large. Edges are whole multiples of the pixel size, so that maps of one
// frame and pixel size fit onto each other. Throws NoMap for more than kMaxMapSide pixels.
MapGrid MakeMapGrid(const std::vector<Eigen::Vector3d>& sample, double pixel_size);

// All tiles along a curve that keeps neighbours together (Hilbert's), so that the pictures that one
// tile needs are at hand for the next.
std::vector<int> TilesAlongCurve(const MapGrid& grid);

}  // namespace colmap_seapoint
