// What a map is handed over as: finished tiles, and whoever takes them.
#pragma once

#include <cstdint>
#include <limits>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/orthomosaic/ground/map_grid.h"

namespace colmap_seapoint {

struct MapFrame;

// What a pixel of the relief stands on; 0 where nothing was reconstructed.
enum SurfaceFlag : uint8_t {
  kMeasured = 1,   // points of the cloud lie in its cell
  kBridged = 2,    // none does, but in a cell next to it, and in one beyond it
  kFilled = 4,     // made up between what lies farther apart: only where that was asked for
  kOverhang = 8,   // another surface lies below
  kUncolored = 16  // no picture that could be read sees it
};

inline constexpr float kNoHeight = std::numeric_limits<float>::quiet_NaN();
inline constexpr int32_t kNoSource = -1;

// One tile: row 0 is the uppermost (north), all four rasters are of one size.
struct MapTile {
  int x = 0, y = 0;        // of its first pixel in the map
  FloatImage relief;       // heights in the map's frame, its unit; kNoHeight where there is none
  Image<uint8_t> rgba;     // alpha 0 where there is no colour, else 255
  Image<int32_t> source;   // position in the model's images; kNoSource where there is no colour
  Image<uint8_t> surface;  // SurfaceFlags
};

// Takes the tiles of a map, all from one thread. A tile without any surface is not handed over.
// What a sink throws (no space left) ends the map and reaches the caller.
class MapTileSink {
 public:
  virtual ~MapTileSink() = default;
  // Once, before any tile.
  virtual void Begin(const MapFrame& frame, const MapGrid& grid) = 0;
  // Each at most once, in an order that depends on the grid alone.
  virtual void Take(MapTile&& tile) = 0;
  // A tile of this box that is as in the map before, where its first pixel was (x, y), which may
  // lie outside of it: returns its source and surface as they are there. Of a map that is
  // continued.
  virtual MapTile TakeOver(const MapGrid::Box&, int, int) {
    SEAPOINT_CHECK(false);  // a sink that knows of no map before
    return {};
  }
};

}  // namespace colmap_seapoint
