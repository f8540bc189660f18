// The coordinates that gaps are written in.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "colmap_seapoint/io/files/map_projection.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "densify/completeness/surface/asked_area.h"
#include "densify/completeness/surface/plan_frame.h"

namespace colmap_seapoint {

// Longitude, latitude (degrees, WGS84) and altitude where the model is georeferenced; else metres,
// or the model's units, in the map's frame: x right, y ahead, z up, which is the model's own frame
// where its z points up.
class GapPlaces {
 public:
  // Throws Error when PROJ does not know the units' CRS.
  GapPlaces(const ModelUnits& units, const PlanFrame& frame);
  Eigen::Vector3d Write(const Eigen::Vector3d& world) const;
  bool IsGeographic() const { return is_geographic_; }
  std::string Description() const;  // a sentence for who reads the file
  std::string Unit() const { return units_.is_metric ? "m" : "units"; }

 private:
  ModelUnits units_;
  PlanFrame frame_;
  bool is_geographic_ = false;
  std::unique_ptr<MapProjection> projection_;
};

// Polygons as ReadAreaGeoJson gives them, in the plan of the map, which must be the world. They are
// geographic where the model is; throws Error for corners that are no longitude and latitude there.
AskedArea AreaInPlan(const ModelUnits& units, const std::vector<Ring>& rings);

}  // namespace colmap_seapoint
