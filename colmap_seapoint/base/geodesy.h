// Conversion of latitude and longitude into metres, near a place.
#pragma once

#include <Eigen/Core>

namespace colmap_seapoint {

// WGS84: degrees, and metres above the ellipsoid (or any other zero: only differences count).
struct GeoPosition {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double altitude_m = 0;
};

// Finite, latitude within +-90, longitude within +-360 (both usual ranges).
bool IsLegal(const GeoPosition& position);

// Metres east, north and up of `origin`, by the ellipsoid's radii there: within 10 km good to a
// thousandth up to 60 degrees of latitude. Across the date line, too.
Eigen::Vector3d LocalEastNorthUp(const GeoPosition& position, const GeoPosition& origin);

// The reverse.
GeoPosition FromLocalEastNorthUp(const Eigen::Vector3d& east_north_up, const GeoPosition& origin);

}  // namespace colmap_seapoint
