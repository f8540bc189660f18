// Which part of a map that is continued is drawn anew.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "colmap_seapoint/orthomosaic/ground/map_view.h"
#include "colmap_seapoint/orthomosaic/map_memory.h"
#include "colmap_seapoint/orthomosaic/relief/relief.h"

namespace colmap_seapoint {

// The map before on the grid of the present one.
struct MapGrowth {
  MapGrid grid;
  int left = 0, above = 0;  // blocks that came in on the left and above
  KnownRelief relief;       // wanted: tiles that new points or new pictures touch

  // A block of the present map in the one before; false outside of it.
  bool BlockBefore(const MapMemory& before, int x, int y, size_t* at) const;
};

// The grid of the map before, grown by whole blocks to where `needed` reaches, and the tiles to
// draw: those with a block within five of a point of the cloud that is new (surfaces reach as far),
// and those with one that a new picture shows, or beside it.
MapGrowth GrowMap(const MapMemory& before, const MapGrid& needed,
                  const std::filesystem::path& cloud_path, const std::vector<MapView>& views);

// By block of the present map, its slot in the map before, -1 where its sources are to be found
// anew: it had no surface, or a new picture shows it.
std::vector<int32_t> KeptSlots(const MapMemory& before, const MapGrowth& growth,
                               const Relief& relief, const std::vector<MapView>& views);

}  // namespace colmap_seapoint
