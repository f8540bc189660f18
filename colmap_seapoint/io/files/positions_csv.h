// The places where pictures were taken, from a table that the user brings (a navigation log, a
// survey).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>

namespace colmap_seapoint {

struct PicturePositions {
  bool is_geographic = false;  // latitude, longitude (degrees), altitude; else x, y, z; metres
  std::map<std::string, Eigen::Vector3d> positions;  // by the picture's name
  // Standard deviations, metres: east (or x), north (y), up (z); empty where the table has none.
  std::map<std::string, Eigen::Vector3d> sigmas;
};

// Comma-separated, with the header line "image,x,y,z", "image,lat,lon,alt" or "image,lat,lon,depth"
// (metres below the surface, returned as a negative altitude), and after these, if known, "sigma"
// (of every axis) or "sigma_xy,sigma_z"; names with a comma stand in double quotes; blank lines and
// lines that start with '#' are skipped. Throws Error with file, line, finding and remedy: no or
// another header, a row of another length, what is no finite number, no latitude or longitude, a
// sigma that is not positive, a name twice, no row at all. `option` named the file.
PicturePositions ReadPositionsCsv(const std::filesystem::path& path,
                                  const std::string& option = "--SpatialMatching.positions_path");

}  // namespace colmap_seapoint
