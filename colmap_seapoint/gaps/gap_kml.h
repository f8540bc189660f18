// The gaps for Google Earth, chart plotters and phones.
#pragma once

#include <string>

#include "colmap_seapoint/gaps/gap_places.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// KML 2.2: a placemark a gap, its outline on the ground; and the route as a line. `places` must be
// geographic.
std::string GapsKml(const CompletenessResult& result, const GapPlaces& places);

}  // namespace colmap_seapoint
