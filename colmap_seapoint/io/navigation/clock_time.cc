#include "colmap_seapoint/io/navigation/clock_time.h"

#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "colmap_seapoint/io/files/csv_table.h"

namespace colmap_seapoint {
namespace {

constexpr double kFirstEpochSecond = 1e9;   // 2001
constexpr double kFirstMillisecond = 1e12;  // the same
constexpr int64_t kSecondsPerDay = 86400;

// Days since 1970 of the Gregorian calendar (Fliegel and Van Flandern's Julian day number).
int64_t DaysSince1970(int year, int month, int day) {
  const int64_t y = year, m = month, d = day;
  const int64_t a = (m - 14) / 12;
  return (1461 * (y + 4800 + a)) / 4 + (367 * (m - 2 - 12 * a)) / 12 -
         (3 * ((y + 4900 + a) / 100)) / 4 + d - 32075 - 2440588;
}

struct Date {
  int year = 0, month = 0, day = 0;
};

Date DateOf(int64_t days) {
  int64_t l = days + 2440588 + 68569;
  const int64_t n = 4 * l / 146097;
  l -= (146097 * n + 3) / 4;
  const int64_t i = 4000 * (l + 1) / 1461001;
  l -= 1461 * i / 4 - 31;
  const int64_t j = 80 * l / 2447;
  const int64_t k = j / 11;
  return {static_cast<int>(100 * (n - 49) + i + k), static_cast<int>(j + 2 - 12 * k),
          static_cast<int>(l - 2447 * j / 80)};
}

// Seconds that a zone ("", "Z", "+02:00", "+0200", "-05") is ahead of UTC.
std::optional<double> ZoneSeconds(std::string zone) {
  while (!zone.empty() && zone.front() == ' ') zone.erase(0, 1);
  if (zone.empty() || zone == "Z" || zone == "z" || zone == "UTC") return 0;
  if (zone[0] != '+' && zone[0] != '-') return std::nullopt;
  int hours = 0, minutes = 0;
  const char* format = zone.find(':') != std::string::npos ? "%2d:%2d" : "%2d%2d";
  if (std::sscanf(zone.c_str() + 1, format, &hours, &minutes) < 1) return std::nullopt;
  const double seconds = 3600.0 * hours + 60.0 * minutes;
  return zone[0] == '+' ? seconds : -seconds;
}

// "hh:mm:ss[.fraction]" and a zone, if any.
std::optional<double> ParseTimeOfDay(const std::string& text) {
  int hours = 0, minutes = 0, used = 0;
  if (std::sscanf(text.c_str(), "%2d:%2d:%n", &hours, &minutes, &used) < 2 || used == 0) {
    return std::nullopt;
  }
  size_t end = static_cast<size_t>(used);
  while (end < text.size() &&
         (std::isdigit(static_cast<unsigned char>(text[end])) != 0 || text[end] == '.')) {
    ++end;
  }
  double seconds = 0;
  if (!ParseCsvNumber(text.substr(static_cast<size_t>(used), end - static_cast<size_t>(used)),
                      &seconds)) {
    return std::nullopt;
  }
  if (hours < 0 || hours > 24 || minutes < 0 || minutes > 59 || seconds >= 61) return std::nullopt;
  const double result = 3600.0 * hours + 60.0 * minutes + seconds;
  const auto zone = ZoneSeconds(text.substr(end));
  if (!zone) return std::nullopt;
  return result - *zone;
}

bool IsDate(const Date& date) {
  return date.year >= 1970 && date.year < 2200 && date.month >= 1 && date.month <= 12 &&
         date.day >= 1 && date.day <= 31;
}

}  // namespace

std::optional<ClockTime> ParseClockTime(const std::string& text) {
  double number = 0;
  if (ParseCsvNumber(text, &number)) {
    if (number >= kFirstMillisecond) return ClockTime{number / 1000, true};
    return ClockTime{number, number >= kFirstEpochSecond};
  }
  Date date;
  char separators[3] = {};
  int used = 0;
  const int found = std::sscanf(text.c_str(), "%4d%c%2d%c%2d%c%n", &date.year, &separators[0],
                                &date.month, &separators[1], &date.day, &separators[2], &used);
  if (found == 6 && used > 0 && IsDate(date) && separators[0] == separators[1] &&
      (separators[2] == ' ' || separators[2] == 'T')) {
    const auto time = ParseTimeOfDay(text.substr(static_cast<size_t>(used)));
    if (!time) return std::nullopt;
    const int64_t days = DaysSince1970(date.year, date.month, date.day);
    return ClockTime{static_cast<double>(days * kSecondsPerDay) + *time, true};
  }
  const auto time = ParseTimeOfDay(text);
  if (!time) return std::nullopt;
  return ClockTime{*time, false};
}

std::string ClockTimeText(const ClockTime& time) {
  char text[64];
  if (!time.is_absolute) {
    std::snprintf(text, sizeof(text), "%.1f s", time.seconds);
    return text;
  }
  const auto whole = static_cast<int64_t>(std::floor(time.seconds));
  const int64_t days = whole / kSecondsPerDay, rest = whole % kSecondsPerDay;
  const Date date = DateOf(days);
  std::snprintf(text, sizeof(text), "%04d-%02d-%02d %02d:%02d:%02d", date.year, date.month,
                date.day, static_cast<int>(rest / 3600), static_cast<int>(rest / 60 % 60),
                static_cast<int>(rest % 60));
  return text;
}

}  // namespace colmap_seapoint
