// The coordinates that gaps are written in.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "colmap_seapoint/io/files/map_projection.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "densify/completeness/surface/map_frame.h"

namespace colmap_seapoint {

// Longitude, latitude (degrees, WGS84) and altitude where the model is georeferenced; else metres,
// or the model's units, in the map's frame: x right, y ahead, z up, which is the model's own frame
// where its z points up.
class GapPlaces {
 public:
  // Throws Error when PROJ does not know the units' CRS.
  GapPlaces(const ModelUnits& units, const MapFrame& frame);
  Eigen::Vector3d Write(const Eigen::Vector3d& world) const;
  bool IsGeographic() const { return is_geographic_; }
  std::string Description() const;  // a sentence for who reads the file
  std::string Unit() const { return units_.is_metric ? "m" : "units"; }

 private:
  ModelUnits units_;
  MapFrame frame_;
  bool is_geographic_ = false;
  std::unique_ptr<MapProjection> projection_;
};

// Of a polygon as ReadAreaGeoJson gives it: the place in the plan of the map. Geographic where the
// model is; throws Error for corners that are no longitude and latitude there. The map must be the
// world.
Eigen::Vector2d AreaCorner(const ModelUnits& units, const Eigen::Vector2d& corner);

}  // namespace colmap_seapoint
