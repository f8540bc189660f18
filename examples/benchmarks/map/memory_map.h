// A whole map in memory, for surveys that are small enough.
#pragma once

#include <optional>

#include "colmap_seapoint/orthomosaic/ground/map_frame.h"
#include "colmap_seapoint/orthomosaic/ground/map_grid.h"
#include "colmap_seapoint/orthomosaic/ground/map_tile.h"

namespace colmap_seapoint {

class MemoryMap : public MapTileSink {
 public:
  void Begin(const MapFrame& frame, const MapGrid& grid) override;
  void Take(MapTile&& tile) override;

  const MapFrame& Frame() const { return *frame_; }
  const MapGrid& Grid() const { return grid_; }
  // All four rasters, as large as the map.
  const MapTile& Whole() const { return whole_; }

 private:
  std::optional<MapFrame> frame_;
  MapGrid grid_;
  MapTile whole_;
};

}  // namespace colmap_seapoint
