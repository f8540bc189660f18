#include "colmap_seapoint/base/geodesy.h"

#include <cmath>

namespace colmap_seapoint {
namespace {

constexpr double kEquatorRadius = 6378137.0;  // WGS84
constexpr double kEccentricity2 = 6.69437999014e-3;
constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;

// Metres a radian of longitude and of latitude.
struct Radii {
  double east, north;
};

Radii RadiiAt(double latitude_deg) {
  const double latitude = latitude_deg * kRadiansPerDegree;
  const double w2 = 1 - kEccentricity2 * std::sin(latitude) * std::sin(latitude);
  const double across = kEquatorRadius / std::sqrt(w2);  // prime vertical
  const double along = kEquatorRadius * (1 - kEccentricity2) / (w2 * std::sqrt(w2));  // meridian
  return {across * std::cos(latitude), along};
}

}  // namespace

bool IsLegal(const GeoPosition& position) {
  return std::abs(position.latitude_deg) <= 90 && std::abs(position.longitude_deg) <= 360 &&
         std::isfinite(position.altitude_m);
}

Eigen::Vector3d LocalEastNorthUp(const GeoPosition& position, const GeoPosition& origin) {
  const Radii radii = RadiiAt(origin.latitude_deg);
  const double east_deg = std::remainder(position.longitude_deg - origin.longitude_deg, 360.0);
  const double north_deg = position.latitude_deg - origin.latitude_deg;
  return {east_deg * kRadiansPerDegree * radii.east, north_deg * kRadiansPerDegree * radii.north,
          position.altitude_m - origin.altitude_m};
}

GeoPosition FromLocalEastNorthUp(const Eigen::Vector3d& east_north_up, const GeoPosition& origin) {
  const Radii radii = RadiiAt(origin.latitude_deg);
  return {origin.latitude_deg + east_north_up.y() / (kRadiansPerDegree * radii.north),
          std::remainder(
              origin.longitude_deg + east_north_up.x() / (kRadiansPerDegree * radii.east), 360.0),
          origin.altitude_m + east_north_up.z()};
}

}  // namespace colmap_seapoint
