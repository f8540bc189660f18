// Times as logs, tables and EXIF write them.
#pragma once

#include <optional>
#include <string>

namespace colmap_seapoint {

struct ClockTime {
  double seconds = 0;
  // Seconds since 1970 (by the clock's own zone, unless the text names one: then UTC); else since
  // some beginning: midnight, the start of a video.
  bool is_absolute = false;
};

// ISO 8601 and its relatives ("2024-05-01T10:11:12.5Z", "2024/05/01 10:11:12+02:00", EXIF's
// "2024:05:01 10:11:12"), a time of day ("10:11:12.5"), or seconds (since 1970 from a billion on;
// milliseconds from 10^12 on). nullopt for anything else.
std::optional<ClockTime> ParseClockTime(const std::string& text);

// "2024-05-01 10:11:12", or "1234.5 s".
std::string ClockTimeText(const ClockTime& time);

}  // namespace colmap_seapoint
