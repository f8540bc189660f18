// The surface of one tile of a map, from the points in it (ours).
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/orthomosaic/ground/map_grid.h"
#include "colmap_seapoint/orthomosaic/relief/cloud_tiles.h"

namespace colmap_seapoint {

// Heights are also known this far around a tile: what may hide its border from a camera.
inline constexpr int kReliefMargin = 16;  // pixels

struct ReliefTile {
  FloatImage heights;      // of the tile and the margin around it, map's unit; kNoHeight: none
  Image<uint8_t> surface;  // of the tile: SurfaceFlags
  bool Empty() const { return heights.Empty(); }
};

struct ReliefOptions {
  int cell_size = 1;       // pixels; divides 16
  double pixel_size = 1;   // map's unit
  double base_height = 0;  // of the points
  bool fill = false;
};

// A cell is what has, or has not, been reconstructed. The points in it are parted where more than
// three cells' heights lie between two of them. Its surface is the uppermost part that goes on in
// two cells around it at least (a fish does not), by the points at its upper end; another such part
// below, in most of the cells around as well, is an overhang. An empty cell gets a surface only
// where a cell next to it and one on the opposite side, at most two away, have one that goes on
// through it: gaps of two cells close, and nothing grows beyond a border. With `fill`,
// also between what lies up to 48 pixels apart along row and column. A pixel's height is that of
// the plane through the cell and those around it that belong to the same surface, weighted by
// confidence and nearness. Pure; about 0.15 microseconds a point and as much a cell.
ReliefTile MakeReliefTile(const ReliefOptions& options, const std::vector<TilePoint>& points,
                          const MapGrid::Box& box);

}  // namespace colmap_seapoint
