// A vehicle's or a diver's navigation log: where it was at which time, as a table that the user
// brings.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/navigation/clock_time.h"

namespace colmap_seapoint {

struct NavFix {
  double seconds = 0;
  // Latitude, longitude (degrees), altitude; or x, y, z; metres. Below the surface it is negative.
  Eigen::Vector3d position;
};

struct NavLog {
  bool is_absolute = false;    // the seconds are since 1970 (ClockTime)
  bool is_geographic = false;  // latitude and longitude
  bool has_height = false;     // else the third coordinate is 0
  std::vector<NavFix> fixes;   // by time, one a time
};

// Several logs, separated by commas, of one dive one after the other. Each a comma-separated table
// with a header line that names, in any order and among others: time (or timestamp, datetime, utc,
// seconds; or date and time apart), lat and lon (latitude, longitude) or x and y (easting,
// northing), and if known depth (metres, downwards), else altitude, alt, height or z. Units behind
// a name, in brackets or after an underscore, do not matter. Rows without a time or a position, as
// instruments write them when they know none, are skipped, and one line says how many; rows may be
// in any order. Throws Error with file, finding and remedy: no such column, times of two kinds, no
// usable row, two logs that overlap in time or differ in what they tell.
NavLog ReadNavLogs(const std::string& paths, const std::string& option);

struct PictureTime {
  std::string image;
  ClockTime time;
};

// A table of the pictures' times: image (or name, frame, picture, file) and time (or timestamp,
// datetime, seconds). Throws Error as above.
std::vector<PictureTime> ReadPictureTimes(const std::filesystem::path& path,
                                          const std::string& option);

}  // namespace colmap_seapoint
