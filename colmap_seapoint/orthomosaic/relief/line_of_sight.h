// Whether the surface itself stands between a place of the map and a camera.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap_seapoint/orthomosaic/ground/map_grid.h"
#include "colmap_seapoint/orthomosaic/relief/relief.h"

namespace colmap_seapoint {

// A place of space over the map: column and row, pixels of the map, and height.
using MapPlace = Eigen::Vector3d;

// The way from a place towards a camera, for places near it as well.
struct Rise {
  double dx = 0, dy = 0;  // of unit length together
  double length = 0;      // pixels
  double slope = 0;       // map's unit a pixel
  double reach = 0;       // pixels of the way that are looked along
};

// By blocks alone: what may be seen at all. The mean heights of blocks hide less than the surface
// does. From the centre of block (x, y).
bool IsBlockHidden(const BlockRelief& blocks, int x, int y, const MapPlace& camera,
                   double pixel_size);

// In one tile, pixel by pixel, and beyond it by blocks. What hides a place by less than `tolerance`
// does not: noise casts no shadows.
class LineOfSight {
 public:
  LineOfSight(const ReliefTile& tile, const MapGrid::Box& box, const BlockRelief& blocks,
              double tolerance);

  // `place`: on the surface, in the tile. About 60 ns.
  bool IsHidden(const MapPlace& place, const MapPlace& camera) const {
    return IsHiddenAlong(place, RiseTo(place, camera));
  }
  // The same on a way that is known.
  bool IsHiddenAlong(const MapPlace& place, const Rise& rise) const;
  // Beyond so many pixels of the way nothing hides what lies within half a block of the place and
  // not below it.
  double ReachOf(const MapPlace& place, const Rise& rise) const;
  static Rise RiseTo(const MapPlace& place, const MapPlace& camera);  // all of it is looked along

 private:
  double TopAround(double x, double y) const;

  const FloatImage& heights_;
  const MapGrid::Box box_;
  const BlockRelief& blocks_;
  double tolerance_;
  // Of the tile with its margin: the highest place of every block and of the eight around it.
  FloatImage block_tops_;
};

}  // namespace colmap_seapoint
