#include "colmap_seapoint/navigation/log_positions.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "colmap_seapoint/base/geodesy.h"

namespace colmap_seapoint {
namespace {

constexpr double kHalfHour = 1800;  // time zones differ by multiples of it
constexpr size_t kMaxNamed = 4;
constexpr int kMaxZone = 28;  // half hours

std::string Seconds(double seconds) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.1f s", std::abs(seconds) < 0.05 ? 0 : seconds);
  return text;
}

// "2 h 0 min 34.8 s ahead of the camera's".
std::string AheadText(double offset) {
  const double size = std::abs(offset);
  const char* side = offset >= 0 ? " ahead of the camera's" : " behind the camera's";
  if (size < kHalfHour) return Seconds(size) + side;
  char text[96];
  const double hours = std::floor(size / 3600), minutes = std::floor((size - 3600 * hours) / 60);
  std::snprintf(text, sizeof(text), "%.0f h %.0f min %.1f s", hours, minutes,
                size - 3600 * hours - 60 * minutes);
  return text + std::string(side);
}

struct Span {
  double first, last;
};

Span SpanOf(const std::vector<TimedPicture>& pictures) {
  const auto [first, last] = std::minmax_element(
      pictures.begin(), pictures.end(),
      [](const auto& a, const auto& b) { return a.time.seconds < b.time.seconds; });
  return {first->time.seconds, last->time.seconds};
}

std::vector<LogFix> FixesOf(const NavLog& log) {
  std::vector<LogFix> fixes;
  for (const NavFix& fix : log.fixes) fixes.push_back({fix.seconds, fix.position});
  return fixes;
}

// East, north and up of the log's first fix.
std::vector<LogFix> InMetres(const NavLog& log) {
  std::vector<LogFix> fixes = FixesOf(log);
  if (!log.is_geographic) return fixes;
  const auto geo = [](const Eigen::Vector3d& p) { return GeoPosition{p.x(), p.y(), p.z()}; };
  const GeoPosition origin = geo(log.fixes.front().position);
  for (LogFix& fix : fixes) fix.metres = LocalEastNorthUp(geo(fix.metres), origin);
  return fixes;
}

// The part of a range at whose offsets the log and the pictures share any time; empty: none.
std::vector<OffsetRange> Shared(const OffsetRange& range, const Span& pictures, const Span& log) {
  const OffsetRange shared{std::max(range.low, log.first - pictures.last),
                           std::min(range.high, log.last - pictures.first)};
  if (shared.low > shared.high) return {};
  return {shared};
}

class ClockSearch {
 public:
  ClockSearch(const std::vector<TimedPicture>& pictures, const NavLog& log)
      : fixes_(InMetres(log)),
        pictures_(SpanOf(pictures)),
        log_{log.fixes.front().seconds, log.fixes.back().seconds} {
    for (const TimedPicture& picture : pictures) {
      track_.push_back({picture.time.seconds, picture.in_model});
    }
  }

  // Of all offsets at which the two share any time.
  ClockOffset SearchAll() const {
    const double infinity = std::numeric_limits<double>::infinity();
    return FindClockOffset(track_, fixes_, Shared({-infinity, infinity}, pictures_, log_));
  }

  // Near 0 first; then near every time zone.
  ClockOffset SearchZones(double max_offset) const {
    const ClockOffset near =
        FindClockOffset(track_, fixes_, Shared({-max_offset, max_offset}, pictures_, log_));
    if (near.problem.empty()) return near;
    std::vector<OffsetRange> ranges;
    for (int zone = -kMaxZone; zone <= kMaxZone; ++zone) {
      const double middle = zone * kHalfHour;
      const auto shared = Shared({middle - max_offset, middle + max_offset}, pictures_, log_);
      ranges.insert(ranges.end(), shared.begin(), shared.end());
    }
    if (ranges.empty()) return near;
    const ClockOffset far = FindClockOffset(track_, fixes_, ranges);
    return far.problem.empty() ? far : near;
  }

  bool EverShareTime(double max_offset) const {
    const double reach = kMaxZone * kHalfHour + max_offset;
    return !Shared({-reach, reach}, pictures_, log_).empty();
  }

 private:
  std::vector<TimedCenter> track_;
  std::vector<LogFix> fixes_;
  Span pictures_, log_;
};

std::string SpanText(const Span& span, bool is_absolute) {
  return ClockTimeText({span.first, is_absolute}) + " to " +
         ClockTimeText({span.last, is_absolute});
}

std::string ClockText(const ClockOffset& offset, double taken) {
  if (offset.is_determined) {
    std::string text = "its clock is " + AheadText(offset.seconds) + " (" + Seconds(offset.low) +
                       " to " + Seconds(offset.high) + " fit)";
    if (std::abs(offset.seconds) >= kHalfHour) text += "; one of the two is in another time zone";
    return text;
  }
  const std::string taken_text =
      "; " + Seconds(taken) +
      " is taken, so that places along the track may be off by as much time (give --nav_offset if "
      "you know it)";
  std::string text = "how far its clock is from the camera's cannot be determined: ";
  const auto& several = offset.alternatives;
  if (several.size() < 2) {
    return text + "all from " + Seconds(offset.low) + " to " + Seconds(offset.high) +
           " fit equally well, as on a straight track at constant speed" + taken_text;
  }
  for (size_t i = 0; i < std::min(several.size(), kMaxNamed); ++i) {
    text += (i == 0 ? "" : ", ") + Seconds(several[i]);
  }
  return text + (several.size() > kMaxNamed ? " and others" : "") + ", from " +
         Seconds(offset.low) + " to " + Seconds(offset.high) +
         ", fit equally well: the track repeats itself" + taken_text;
}

void AddPlaces(const std::vector<TimedPicture>& pictures, const NavLog& log, double offset,
               PicturePositions* positions) {
  const std::vector<LogFix> fixes = FixesOf(log);
  positions->is_geographic = log.is_geographic;
  for (const TimedPicture& picture : pictures) {
    const auto place = PlaceAt(fixes, picture.time.seconds + offset);
    if (place) positions->positions[picture.name] = *place;
  }
}

std::string OtherDay(const std::vector<TimedPicture>& pictures, const NavLog& log) {
  return "it is of another time: it goes from " +
         SpanText({log.fixes.front().seconds, log.fixes.back().seconds}, log.is_absolute) +
         ", the pictures from " + SpanText(SpanOf(pictures), pictures.front().time.is_absolute);
}

}  // namespace

LogPositions PlaceByLog(const std::vector<TimedPicture>& pictures, const NavLog& log,
                        const LogClockOptions& options) {
  LogPositions result;
  if (pictures.empty()) {
    result.problem = "no picture of the model has a time";
    return result;
  }
  const bool is_same_kind = pictures.front().time.is_absolute == log.is_absolute;
  const ClockSearch search(pictures, log);
  if (options.known_offset) {
    result.offset.is_determined = true;
    result.offset.seconds = result.offset.low = result.offset.high = *options.known_offset;
  } else if (is_same_kind && !search.EverShareTime(options.max_offset)) {
    result.problem = OtherDay(pictures, log);
    return result;
  } else {
    result.offset = is_same_kind ? search.SearchZones(options.max_offset) : search.SearchAll();
  }
  const ClockOffset& offset = result.offset;
  if (!offset.problem.empty()) {
    result.problem = offset.problem;
    return result;
  }
  const bool is_zero_as_good = offset.low <= 0 && offset.high >= 0;
  const double taken = !offset.is_determined && is_zero_as_good ? 0 : offset.seconds;
  AddPlaces(pictures, log, taken, &result.positions);
  result.text = options.known_offset
                    ? "its clock is taken to be " + AheadText(taken) + ", as --nav_offset says"
                    : ClockText(offset, taken);
  if (result.positions.positions.empty()) result.problem = OtherDay(pictures, log);
  return result;
}

}  // namespace colmap_seapoint
