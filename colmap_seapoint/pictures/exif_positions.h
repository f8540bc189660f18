// What the pictures' own EXIF and XMP tell of where and when they were taken.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/io/files/positions_csv.h"
#include "colmap_seapoint/io/navigation/nav_log.h"
#include "colmap_seapoint/pictures/image_reader.h"

namespace colmap_seapoint {

struct ExifPositions {
  PicturePositions positions;  // latitude, longitude, height; empty: there are none of use
  std::string heights;         // what the heights are, for a person; "no height: taken as level"
  std::string problem;         // why GPS that is there is not used; empty: it is, or there is none
};

// A position at (0, 0) is what receivers write that know none, and is left out with a warning.
// Heights are of one kind for all: depth, else GPS altitude, else height above the start, whichever
// most pictures tell; pictures without it are left out, unless hardly any has one: then all are
// taken as level. Positions that are all the same (a telephone that had its last fix above water)
// are none. The projected system for metres is SuggestedCrs().
ExifPositions PositionsFromExif(const std::vector<ReadablePicture>& pictures);

// UTM on WGS84 for the middle of the positions, "EPSG:32755"; "" near the poles, where there is
// none.
std::string SuggestedCrs(const PicturePositions& positions);

// The pictures whose EXIF tells when they were taken. Where no camera writes fractions, half a
// second is added: a clock that drops them is that much behind on average.
std::vector<PictureTime> TimesFromExif(const std::vector<ReadablePicture>& pictures);

// All of this of the pictures of a run, read once.
struct PictureRecords {
  ExifPositions gps;
  std::vector<PictureTime> times;
  // Whether it says anything, be it that it cannot be used.
  bool HasGps() const { return !gps.positions.positions.empty() || !gps.problem.empty(); }
};

PictureRecords RecordsFromExif(const std::vector<ReadablePicture>& pictures);

}  // namespace colmap_seapoint
