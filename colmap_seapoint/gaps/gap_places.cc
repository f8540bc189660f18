#include "colmap_seapoint/gaps/gap_places.h"

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/geodesy.h"

namespace colmap_seapoint {
namespace {

bool IsEastNorthUp(const ModelUnits& units) {
  return units.frame == "east-north-up" && units.origin.has_value();
}

bool IsProjected(const ModelUnits& units) {
  return units.frame == "projected" && !units.crs.empty();
}

}  // namespace

GapPlaces::GapPlaces(const ModelUnits& units, const MapFrame& frame)
    : units_(units), frame_(frame) {
  if (IsProjected(units)) projection_ = std::make_unique<MapProjection>(units.crs);
  is_geographic_ = projection_ != nullptr || IsEastNorthUp(units);
}

Eigen::Vector3d GapPlaces::Write(const Eigen::Vector3d& world) const {
  if (!is_geographic_) {
    return frame_.IsWorld() ? Eigen::Vector3d(world + units_.offset)
                            : Eigen::Vector3d(frame_.map_from_world * world);
  }
  const Eigen::Vector3d place = world + units_.offset;
  const GeoPosition position =
      projection_ ? projection_->ToGeographic(place) : FromLocalEastNorthUp(place, *units_.origin);
  return {position.longitude_deg, position.latitude_deg, position.altitude_m};
}

std::string GapPlaces::Description() const {
  if (is_geographic_) return "WGS84 longitude, latitude, altitude";
  const std::string unit = units_.is_metric ? "local metres" : "the model's arbitrary units";
  if (frame_.IsWorld()) return unit + ", the model's own frame, not WGS84";
  return unit + ", the map's frame (map_from_model turns the model into it), not WGS84";
}

Eigen::Vector2d AreaCorner(const ModelUnits& units, const Eigen::Vector2d& corner) {
  const GeoPosition position = {corner.y(), corner.x(), 0};
  if (!IsEastNorthUp(units) && !IsProjected(units)) return corner - units.offset.head<2>();
  if (!IsLegal(position)) {
    throw Error("--area", "a corner is no longitude and latitude, as the model's place needs",
                "save the polygon in WGS84 (EPSG:4326)");
  }
  if (IsEastNorthUp(units)) {
    return (LocalEastNorthUp(position, *units.origin) - units.offset).head<2>();
  }
  return (MapProjection(units.crs).FromGeographic(position) - units.offset).head<2>();
}

}  // namespace colmap_seapoint
