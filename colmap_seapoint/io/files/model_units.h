// units.json beside a model or a cloud: what its coordinates mean. A model without one is as the
// mapper left it: of arbitrary units.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>

#include "colmap_seapoint/base/geodesy.h"

namespace colmap_seapoint {

struct ModelUnits {
  bool is_metric = false;
  // "model" (orientation and origin are the mapper's), "local" (of the given x, y, z),
  // "east-north-up" (about `origin`), or "projected" (in `crs`).
  std::string frame = "model";
  std::string crs;                    // "EPSG:32755"
  std::optional<GeoPosition> origin;  // of east-north-up
  // Added to the coordinates of the files, these are those of `frame`: kept apart, since a cloud's
  // floats have 7 digits only.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  // Standard deviation of the scale over the scale; in the file null where units are arbitrary.
  double scale_sigma_relative = 0;
};

inline constexpr char kUnitsFile[] = "units.json";

// nullopt when `dir` has no such file. Throws Error when it holds something else.
std::optional<ModelUnits> ReadModelUnits(const std::filesystem::path& dir);
// Of a file of any name, which must be there.
ModelUnits ReadModelUnitsFile(const std::filesystem::path& path);
// Atomic.
void WriteModelUnits(const std::filesystem::path& dir, const ModelUnits& units);

// The reference system of `frame`, as WellKnownText() takes it: `crs`, or of east-north-up about an
// origin the plane that touches the ellipsoid there, which LocalEastNorthUp() keeps to but for
// 3e-5 of the distance from it (2 cm in 600 m). "" where the frame is nowhere on the Earth.
std::string ReferenceSystem(const ModelUnits& units);

// "arbitrary" or "metres": for run.json.
std::string UnitsWord(const std::optional<ModelUnits>& units);
// "units arbitrary", or e.g. "metres, east-north-up of latitude 43.1000000, longitude 5.9000000".
std::string UnitsText(const std::optional<ModelUnits>& units);

}  // namespace colmap_seapoint
