// Coordinates of a projected reference system (EPSG:32755, ...), by PROJ.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "colmap_seapoint/base/geodesy.h"

namespace colmap_seapoint {

class MapProjection {
 public:
  // `crs` as PROJ knows it, e.g. "EPSG:32755". Throws Error when PROJ does not know it, or when it
  // is no projected system with axes in metres (latitude and longitude; feet).
  explicit MapProjection(const std::string& crs);
  ~MapProjection();
  MapProjection(const MapProjection&) = delete;
  MapProjection& operator=(const MapProjection&) = delete;

  // Easting, northing, altitude (as it is: heights are not converted), metres, from WGS84. Throws
  // Error where the system does not reach.
  Eigen::Vector3d FromGeographic(const GeoPosition& position) const;

  // The reverse.
  GeoPosition ToGeographic(const Eigen::Vector3d& position) const;

  const std::string& Name() const { return name_; }  // "WGS 84 / UTM zone 55S"

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::string crs_, name_;
};

// The well-known text of a reference system, for files that carry it: "EPSG:32755", another
// authority's code, a PROJ string or a text of any version itself. Version 1 (GDAL's), which every
// program reads, where it can express the system; else the newest. `file` needs it, for the Error
// that is thrown when PROJ does not know the system.
std::string WellKnownText(const std::string& crs, const std::string& file);

}  // namespace colmap_seapoint
