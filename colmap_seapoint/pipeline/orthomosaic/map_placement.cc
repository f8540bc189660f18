#include "colmap_seapoint/pipeline/orthomosaic/map_placement.h"

namespace colmap_seapoint {

MapPlacement PlaceMap(const MapFrame& frame, const std::optional<ModelUnits>& units) {
  MapPlacement placement;
  if (!units) return placement;
  if (units->is_metric) placement.unit = "metre";
  const bool is_models_own =
      frame.kind == PlaneKind::kLevel && frame.map_from_cloud.rotation.matrix().isIdentity();
  if (!is_models_own) return placement;
  placement.offset = units->offset;
  placement.crs = ReferenceSystem(*units);
  return placement;
}

RasterLayout LayoutOfMap(const MapGrid& grid, const MapPlacement& placement, RasterBands bands) {
  RasterLayout layout;
  layout.bands = bands;
  layout.width = grid.width;
  layout.height = grid.height;
  layout.tile_size = grid.tile_size;
  layout.min_x = grid.left + placement.offset.x();
  layout.max_y = grid.top + placement.offset.y();
  layout.pixel_size = grid.pixel_size;
  layout.crs = placement.crs;
  return layout;
}

}  // namespace colmap_seapoint
