// Polygons that a user has drawn in QGIS.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace colmap_seapoint {

// Rings of all polygons (Polygon, MultiPolygon; in a feature, a collection of them, or alone),
// holes among them, as they stand there: longitude and latitude in degrees, or x and y. The corner
// that repeats the first one is dropped. Throws Error for what cannot be read, is no GeoJSON, holds
// no polygon, a corner that is not finite, or a ring of fewer than three corners. `option` as the
// user gave the file.
std::vector<std::vector<Eigen::Vector2d>> ReadAreaGeoJson(const std::filesystem::path& path,
                                                          const std::string& option);

}  // namespace colmap_seapoint
