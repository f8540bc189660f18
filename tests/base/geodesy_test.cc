#include "colmap_seapoint/base/geodesy.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace colmap_seapoint {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

// The definition: WGS84's ellipsoid in space.
Eigen::Vector3d Ecef(const GeoPosition& p) {
  const double a = 6378137, f = 1 / 298.257223563, e2 = f * (2 - f);
  const double lat = p.latitude_deg * kDegree, lon = p.longitude_deg * kDegree;
  const double n = a / std::sqrt(1 - e2 * std::sin(lat) * std::sin(lat));
  return {(n + p.altitude_m) * std::cos(lat) * std::cos(lon),
          (n + p.altitude_m) * std::cos(lat) * std::sin(lon),
          (n * (1 - e2) + p.altitude_m) * std::sin(lat)};
}

TEST(LocalEastNorthUp, AgreesWithTheEllipsoidNearby) {
  for (const GeoPosition origin : {GeoPosition{43.1, 5.9, 0}, GeoPosition{-33.9, 151.2, -20},
                                   GeoPosition{0, 0, 0}, GeoPosition{59.9, 179.9999, 5}}) {
    for (const auto& [north, east, up] :
         {std::tuple(0.0005, -0.0007, 3.0), {-0.002, 0.001, -9.0}, {0, 0.0002, 0}}) {
      const GeoPosition position = {origin.latitude_deg + north, origin.longitude_deg + east,
                                    origin.altitude_m + up};
      const Eigen::Vector3d difference = Ecef(position) - Ecef(origin);
      const double lat = origin.latitude_deg * kDegree, lon = origin.longitude_deg * kDegree;
      const Eigen::Vector3d e(-std::sin(lon), std::cos(lon), 0);
      const Eigen::Vector3d u(std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon),
                              std::sin(lat));
      const Eigen::Vector3d local = LocalEastNorthUp(position, origin);
      EXPECT_NEAR(local.x(), e.dot(difference), 0.02);
      EXPECT_NEAR(local.y(), u.cross(e).dot(difference), 0.02);
      EXPECT_NEAR(local.z(), up, 1e-9);
    }
  }
}

TEST(LocalEastNorthUp, AcrossTheDateLine) {
  const GeoPosition west = {10, 179.9995, 0}, east = {10, -179.9995, 0};
  EXPECT_NEAR(LocalEastNorthUp(east, west).x(), 109.6, 0.1);
  EXPECT_NEAR(LocalEastNorthUp(west, east).x(), -109.6, 0.1);
}

TEST(IsLegal, Ranges) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(IsLegal({-90, 180, -11000}));
  EXPECT_TRUE(IsLegal({0, 359.9, 0}));
  for (const GeoPosition& bad :
       {GeoPosition{90.1, 0, 0}, {0, 361, 0}, {nan, 0, 0}, {0, nan, 0}, {0, 0, nan}}) {
    EXPECT_FALSE(IsLegal(bad));
  }
}

}  // namespace
}  // namespace colmap_seapoint
