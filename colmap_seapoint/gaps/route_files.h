// The route over all gaps for vehicles that steer themselves.
#pragma once

#include <string>

#include "colmap_seapoint/gaps/gap_places.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// All three hold the corners of the passes in the order in which they are swum, in WGS84; `places`
// must be geographic, and the route not empty. Heights of a model whose route lies below 0 are
// depths: they are relative to where the vehicle starts, which is at the surface; others are above
// mean sea level.

// QGroundControl's Plan, version 1: JSON with a SimpleItem (MAV_CMD_NAV_WAYPOINT) a corner; home is
// above the first one, at height 0. For ArduSub and others of ArduPilot.
std::string RoutePlan(const CompletenessResult& result, const GapPlaces& places);

// MAVLink's mission in plain text, "QGC WPL 110", which Mission Planner, QGroundControl and
// MAVProxy read. Item 0 is home.
std::string RouteWaypoints(const CompletenessResult& result, const GapPlaces& places);

// A mission of BlueRobotics' Cockpit (Mission library, Import): JSON, version 0. Every waypoint has
// one command, as Cockpit's own have.
std::string RouteCockpitMission(const CompletenessResult& result, const GapPlaces& places);

}  // namespace colmap_seapoint
