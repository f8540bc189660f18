// Where pictures were taken, from a table that the user brings (a navigation log, a survey).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>

namespace colmap_seapoint {

struct PicturePositions {
  bool is_geographic = false;  // latitude, longitude (degrees), altitude; else x, y, z; metres
  std::map<std::string, Eigen::Vector3d> positions;  // by the picture's name
};

// Comma-separated, with the header line "image,x,y,z" or "image,lat,lon,alt"; names with a comma
// stand in double quotes; blank lines and lines that start with '#' are skipped. Throws Error with
// file, line, finding and remedy: no or another header, a row of another length, what is no finite
// number, no latitude or longitude, a name twice, no row at all.
PicturePositions ReadPositionsCsv(const std::filesystem::path& path);

}  // namespace colmap_seapoint
