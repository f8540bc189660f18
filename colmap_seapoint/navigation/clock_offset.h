// How far the clock of a navigation log is ahead of the camera's, found from what both know: the
// camera's track (ours).
//
// A camera's clock is set by hand, a log's by satellites, and half a minute between them is usual.
// At each offset, the log says where every picture was taken, and the similarity that brings the
// model's track onto these places leaves a residual; at the true offset it is the log's noise. A
// straight track at constant speed fits everywhere, and strips that repeat each other fit several
// times: then the offset cannot be determined.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace colmap_seapoint {

struct TimedCenter {
  double seconds = 0;        // by the camera's clock
  Eigen::Vector3d in_model;  // camera centre, model units
};

struct LogFix {
  double seconds = 0;      // by the log's clock
  Eigen::Vector3d metres;  // any frame
};

// Offsets that are looked at, seconds, both ends inclusive.
struct OffsetRange {
  double low = -120, high = 120;
};

// Places between two fixes that are farther apart in time than this are not known, seconds.
inline constexpr double kMaxLogGap = 10;
// A better known offset is determined: half the width of the interval that fits, seconds.
inline constexpr double kMaxOffsetUncertainty = 0.5;

struct ClockOffset {
  // Why there is no offset, a sentence for a diver; empty: there is one.
  std::string problem;
  // False where so many offsets fit as well that none is known: then low and high say which, and
  // `seconds` is the best of them.
  bool is_determined = false;
  double seconds = 0;        // log's clock minus camera's
  double low = 0, high = 0;  // what fits as well as noise can tell
  // Where the cost is least in each separate stretch of these, the best one first: several where
  // the track repeats itself.
  std::vector<double> alternatives;
  double rms_m = 0;       // of the fit at `seconds`
  size_t num_placed = 0;  // pictures that the log has a place for, at `seconds`
};

// The log with its fixes in the order of their times, one a time (the first), without what is not
// finite.
std::vector<LogFix> SortedFixes(std::vector<LogFix> log);

// Where the log was at a time, linear between two fixes at most kMaxLogGap apart; nullopt where it
// does not say. `log` as SortedFixes returns it.
std::optional<Eigen::Vector3d> PlaceAt(const std::vector<LogFix>& log, double seconds);

// Robust against a fifth of wrong fixes. The cost of an offset is the mean squared residual over
// the squared extent of the track, so that a log that stands still fits nothing; an offset counts
// where the log places half of the pictures. All offsets whose cost lies within the chance scatter
// of the least one's fit as well: 1 + 4 sqrt(2 / n), of n independent residuals; but not those of a
// separate stretch at which the log places clearly fewer of the pictures, since it was written
// during the whole dive. Never throws. One
// thread; about 20 microseconds an offset, two offsets a second of `ranges`.
ClockOffset FindClockOffset(const std::vector<TimedCenter>& track, const std::vector<LogFix>& log,
                            const std::vector<OffsetRange>& ranges);

}  // namespace colmap_seapoint
