#include "colmap_seapoint/gaps/gap_places.h"

#include <optional>

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

GapPlaces::GapPlaces(const ModelUnits& units, const PlanFrame& frame)
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

AskedArea AreaInPlan(const ModelUnits& units, const std::vector<Ring>& rings) {
  std::optional<MapProjection> projection;
  if (IsProjected(units)) projection.emplace(units.crs);
  const auto in_plan = [&](const Eigen::Vector2d& corner) -> Eigen::Vector2d {
    if (!IsEastNorthUp(units) && !projection) return corner - units.offset.head<2>();
    const GeoPosition position = {corner.y(), corner.x(), 0};
    if (!IsLegal(position)) {
      throw Error("--area", "a corner is no longitude and latitude, as the model's place needs",
                  "save the polygon in WGS84 (EPSG:4326)");
    }
    const Eigen::Vector3d place = projection ? projection->FromGeographic(position)
                                             : LocalEastNorthUp(position, *units.origin);
    return (place - units.offset).head<2>();
  };
  AskedArea area;
  for (const Ring& ring : rings) {
    Ring& corners = area.rings.emplace_back();
    for (const Eigen::Vector2d& corner : ring) corners.push_back(in_plan(corner));
  }
  return area;
}

}  // namespace colmap_seapoint
