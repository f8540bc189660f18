// Where coded markers were found in pictures, as a table.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace colmap_seapoint {

struct MarkerSighting {
  std::string marker;  // "tag36h11:12"
  std::string image;
  int width = 0, height = 0;  // of the picture that it was found in, pixels
  // COLMAP's convention: the first pixel's centre is (0.5, 0.5). Around the marker's black square,
  // the first one always the same corner of the print.
  std::array<Eigen::Vector2d, 4> corners;
  bool is_mirrored = false;
};

inline constexpr char kMarkersHeader[] =
    "marker,image,width,height,x1,y1,x2,y2,x3,y3,x4,y4,mirrored";

// kMarkersHeader, then one sighting a line; coordinates to a thousandth of a pixel.
std::string MarkersCsv(const std::vector<MarkerSighting>& sightings);

// Throws Error with file, line, finding and remedy: another header, a row of another length, no
// name, what is no number. A table without a row is legal: no marker was found.
std::vector<MarkerSighting> ReadMarkersCsv(const std::filesystem::path& path);

}  // namespace colmap_seapoint
