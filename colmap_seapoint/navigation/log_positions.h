// From a navigation log and the times of pictures to where the pictures were taken.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/io/files/positions_csv.h"
#include "colmap_seapoint/io/navigation/nav_log.h"
#include "colmap_seapoint/navigation/clock_offset.h"

namespace colmap_seapoint {

struct TimedPicture {
  std::string name;
  ClockTime time;            // by the camera's clock; all of one kind
  Eigen::Vector3d in_model;  // camera centre, model units
};

struct LogClockOptions {
  std::optional<double> known_offset;  // seconds, log's clock minus camera's
  double max_offset = 120;             // seconds: how far two clocks of one kind may differ
};

struct LogPositions {
  // Why there are none, a sentence for a diver; empty: there are.
  std::string problem;
  PicturePositions positions;  // of the pictures that the log has a place for
  ClockOffset offset;
  std::string text;  // what was found of the clock, in plain words
};

// Clocks of one kind (both with a date, or both without) are taken to differ by max_offset at most,
// or by a time zone more: the zones are tried where the log fits the track at no smaller offset.
// Where only one of them knows the date, all offsets count. An offset that cannot be determined is
// taken as 0 where that fits as well, and `text` says so. Never throws.
LogPositions PlaceByLog(const std::vector<TimedPicture>& pictures, const NavLog& log,
                        const LogClockOptions& options);

}  // namespace colmap_seapoint
