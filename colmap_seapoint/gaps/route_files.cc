#include "colmap_seapoint/gaps/route_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/gaps/gap_files.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

// MAVLink's numbers.
constexpr int kNavWaypoint = 16, kFrameGlobal = 0, kFrameRelative = 3;
constexpr int kArduPilot = 3, kSubmarine = 12;
// QGroundControl's.
constexpr int kAltitudeRelative = 1, kAltitudeAbsolute = 2;
constexpr double kCruiseSpeed = 0.4;  // m/s: slow enough for sharp pictures

struct Waypoint {
  double latitude = 0, longitude = 0;  // degrees, to a millimetre
  double altitude = 0;                 // metres, to a centimetre
};

struct VehicleRoute {
  std::vector<Waypoint> waypoints;
  bool is_relative = false;  // altitudes are depths below the start
};

VehicleRoute RouteOf(const CompletenessResult& result, const GapPlaces& places) {
  SEAPOINT_CHECK(places.IsGeographic() && !result.route.empty());
  VehicleRoute route;
  route.is_relative = true;
  for (const Eigen::Vector3d& corner : RouteCorners(result)) {
    const Eigen::Vector3d p = places.Write(corner);
    route.waypoints.push_back({std::round(p.y() * 1e8) / 1e8, std::round(p.x() * 1e8) / 1e8,
                               std::round(p.z() * 100) / 100});
    route.is_relative = route.is_relative && p.z() < 0;
  }
  return route;
}

double HomeAltitude(const VehicleRoute& route) {
  return route.is_relative ? 0 : route.waypoints.front().altitude;
}

Json PlanItem(const Waypoint& place, bool is_relative, int number) {
  return {{"AMSLAltAboveTerrain", nullptr},
          {"Altitude", place.altitude},
          {"AltitudeMode", is_relative ? kAltitudeRelative : kAltitudeAbsolute},
          {"autoContinue", true},
          {"command", kNavWaypoint},
          {"doJumpId", number},
          {"frame", is_relative ? kFrameRelative : kFrameGlobal},
          {"params", {0, 0, 0, nullptr, place.latitude, place.longitude, place.altitude}},
          {"type", "SimpleItem"}};
}

}  // namespace

std::string RoutePlan(const CompletenessResult& result, const GapPlaces& places) {
  const VehicleRoute route = RouteOf(result, places);
  const Waypoint& first = route.waypoints.front();
  Json items = Json::array();
  for (const Waypoint& waypoint : route.waypoints) {
    items.push_back(PlanItem(waypoint, route.is_relative, static_cast<int>(items.size()) + 1));
  }
  const Json mission = {
      {"cruiseSpeed", kCruiseSpeed},
      {"firmwareType", kArduPilot},
      {"globalPlanAltitudeMode", route.is_relative ? kAltitudeRelative : kAltitudeAbsolute},
      {"hoverSpeed", kCruiseSpeed},
      {"items", std::move(items)},
      {"plannedHomePosition", {first.latitude, first.longitude, HomeAltitude(route)}},
      {"vehicleType", kSubmarine},
      {"version", 2}};
  const Json plan = {
      {"fileType", "Plan"},
      {"geoFence", {{"circles", Json::array()}, {"polygons", Json::array()}, {"version", 2}}},
      {"groundStation", "colmap_seapoint"},
      {"mission", mission},
      {"rallyPoints", {{"points", Json::array()}, {"version", 2}}},
      {"version", 1}};
  return plan.dump(1) + "\n";
}

std::string RouteWaypoints(const CompletenessResult& result, const GapPlaces& places) {
  const VehicleRoute route = RouteOf(result, places);
  std::string text = "QGC WPL 110\n";
  int number = 0;
  const auto add = [&](int is_current, int frame, const Waypoint& place, double altitude) {
    char line[160];
    std::snprintf(line, sizeof(line), "%d\t%d\t%d\t%d\t0\t0\t0\t0\t%.8f\t%.8f\t%.2f\t1\n", number++,
                  is_current, frame, kNavWaypoint, place.latitude, place.longitude, altitude);
    text += line;
  };
  add(1, kFrameGlobal, route.waypoints.front(), HomeAltitude(route));
  for (const Waypoint& waypoint : route.waypoints) {
    add(0, route.is_relative ? kFrameRelative : kFrameGlobal, waypoint, waypoint.altitude);
  }
  return text;
}

std::string RouteCockpitMission(const CompletenessResult& result, const GapPlaces& places) {
  const VehicleRoute route = RouteOf(result, places);
  const char* reference =
      route.is_relative ? "Relative to home" : "Absolute (relative to mean sea level)";
  Json waypoints = Json::array();
  for (const Waypoint& place : route.waypoints) {
    waypoints.push_back({{"id", "gap-route-" + std::to_string(waypoints.size() + 1)},
                         {"coordinates", {place.latitude, place.longitude}},
                         {"altitude", place.altitude},
                         {"altitudeReferenceType", reference},
                         {"commands",
                          {{{"type", "MAVLINK_NAV_COMMAND"},
                            {"command", "MAV_CMD_NAV_WAYPOINT"},
                            {"param1", 0},
                            {"param2", 1},
                            {"param3", 0},
                            {"param4", 999}}}}});
  }
  const Waypoint& first = route.waypoints.front();
  const Json mission = {{"version", 0},
                        {"settings",
                         {{"mapCenter", {first.latitude, first.longitude}},
                          {"zoom", 19},
                          {"currentWaypointAltitude", first.altitude},
                          {"currentWaypointAltitudeRefType", reference},
                          {"defaultCruiseSpeed", kCruiseSpeed}}},
                        {"waypoints", std::move(waypoints)}};
  return mission.dump(1) + "\n";
}

}  // namespace colmap_seapoint
