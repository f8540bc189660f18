// Where the files of a map lie on the ground.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "colmap_seapoint/io/files/model_units.h"
#include "colmap_seapoint/io/raster/raster_layout.h"
#include "colmap_seapoint/orthomosaic/ground/map_frame.h"
#include "colmap_seapoint/orthomosaic/ground/map_grid.h"

namespace colmap_seapoint {

struct MapPlacement {
  // Added to a place in the map's frame, this is what the files say. A map of the model's own x and
  // y has the offset of units.json in it, one across another plane none.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  std::string crs;   // as WellKnownText() takes it; empty: nowhere on the Earth
  std::string unit;  // of lengths: "metre"; empty: arbitrary
};

MapPlacement PlaceMap(const MapFrame& frame, const std::optional<ModelUnits>& units);

// A raster over the whole grid, in its tiles.
RasterLayout LayoutOfMap(const MapGrid& grid, const MapPlacement& placement, RasterBands bands);

}  // namespace colmap_seapoint
