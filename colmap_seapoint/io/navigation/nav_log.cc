#include "colmap_seapoint/io/navigation/nav_log.h"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <sstream>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/geodesy.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/files/csv_table.h"

namespace colmap_seapoint {
namespace {

// "Latitude (deg)" and "lat_deg" are "latitude" and "lat".
std::string BareName(std::string name) {
  name = name.substr(0, name.find_first_of("([{"));
  while (!name.empty() && (name.back() == ' ' || name.back() == '_')) name.pop_back();
  std::replace(name.begin(), name.end(), ' ', '_');
  for (const char* unit : {"_m", "_deg", "_s", "_utc", "_iso8601"}) {
    const std::string end = unit;
    if (name.size() > end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0) {
      return name.substr(0, name.size() - end.size());
    }
  }
  return name;
}

class Columns {
 public:
  explicit Columns(const CsvTable& table) : table_(table) {
    std::istringstream names(table.header);
    for (std::string name; std::getline(names, name, ',');) names_.push_back(BareName(name));
  }

  // The first of these names that the table has; nullopt: none.
  std::optional<size_t> Find(std::initializer_list<const char*> wanted) const {
    for (const char* name : wanted) {
      const auto found = std::find(names_.begin(), names_.end(), name);
      if (found != names_.end()) return static_cast<size_t>(found - names_.begin());
    }
    return std::nullopt;
  }

  [[noreturn]] void ThrowMissing(const std::string& what, const std::string& remedy) const {
    throw Error(table_.header_where,
                "the header line '" + table_.header_text.substr(0, 120) + "' names no " + what,
                remedy);
  }

 private:
  const CsvTable& table_;
  std::vector<std::string> names_;
};

std::string FieldOf(const CsvRow& row, size_t column) {
  return column < row.fields.size() ? row.fields[column] : std::string();
}

std::optional<double> NumberAt(const CsvRow& row, size_t column) {
  double value = 0;
  if (!ParseCsvNumber(FieldOf(row, column), &value)) return std::nullopt;
  return value;
}

struct LogColumns {
  size_t time = 0, across = 0, along = 0;  // latitude or x; longitude or y
  std::optional<size_t> date, depth, height;
  bool is_geographic = false;
};

LogColumns FindColumns(const CsvTable& table) {
  const Columns columns(table);
  LogColumns result;
  const auto time = columns.Find({"timestamp", "datetime", "date_time", "time", "utc", "gps_time",
                                  "unix_time", "epoch", "seconds", "t"});
  if (!time) columns.ThrowMissing("time", "name a column time (ISO 8601, or seconds)");
  result.time = *time;
  result.date = columns.Find({"date"});
  const auto latitude = columns.Find({"lat", "latitude"});
  const auto longitude = columns.Find({"lon", "long", "lng", "longitude"});
  const auto x = columns.Find({"x", "easting", "east"});
  const auto y = columns.Find({"y", "northing", "north"});
  if ((!latitude || !longitude) && (!x || !y)) {
    columns.ThrowMissing("position", "name two columns lat and lon (degrees), or x and y (metres)");
  }
  result.is_geographic = latitude && longitude;
  result.across = result.is_geographic ? *latitude : *x;
  result.along = result.is_geographic ? *longitude : *y;
  result.depth = columns.Find({"depth", "water_depth", "pressure_depth"});
  result.height = columns.Find({"altitude", "alt", "height", "elevation", "z"});
  return result;
}

// nullopt where the row does not say all that its columns promise.
std::optional<Eigen::Vector3d> PositionOf(const CsvRow& row, const LogColumns& columns) {
  const auto across = NumberAt(row, columns.across), along = NumberAt(row, columns.along);
  if (!across || !along || (*across == 0 && *along == 0 && columns.is_geographic)) {
    return std::nullopt;
  }
  std::optional<double> height = 0;
  if (columns.depth) {
    height = NumberAt(row, *columns.depth);
    if (height) height = -*height;
  } else if (columns.height) {
    height = NumberAt(row, *columns.height);
  }
  if (!height) return std::nullopt;
  if (columns.is_geographic && !IsLegal({*across, *along, *height})) return std::nullopt;
  return Eigen::Vector3d(*across, *along, *height);
}

NavLog ReadNavLog(const std::filesystem::path& path, const std::string& option) {
  const CsvTable table = ReadCsvTable(path, option);
  if (table.header_where.empty()) {
    throw Error(path.string(), "is empty", "begin it with a header line, e.g. time,lat,lon,depth");
  }
  const LogColumns columns = FindColumns(table);
  NavLog log;
  log.is_geographic = columns.is_geographic;
  log.has_height = columns.depth || columns.height;
  for (const CsvRow& row : table.rows) {
    const std::string date = columns.date ? FieldOf(row, *columns.date) + " " : "";
    const auto time = ParseClockTime(date + FieldOf(row, columns.time));
    const auto position = PositionOf(row, columns);
    if (!time || !position) continue;
    if (!log.fixes.empty() && time->is_absolute != log.is_absolute) {
      throw Error(row.where, "its time is of another kind than those before it",
                  "write all times with their date, or all in seconds");
    }
    log.is_absolute = time->is_absolute;
    log.fixes.push_back({time->seconds, *position});
  }
  if (log.fixes.size() < 2) {
    throw Error(path.string(),
                "holds " + std::to_string(log.fixes.size()) + " rows with a time and a position",
                "write e.g. time,lat,lon,depth and then 2024-05-01T10:11:12.5Z,43.1,5.9,12.3");
  }
  const size_t num_skipped = table.rows.size() - log.fixes.size();
  if (num_skipped > 0) {
    LogWarning(path.string() + ": " + std::to_string(num_skipped) + " of " +
               std::to_string(table.rows.size()) + " rows have no time or no position: skipped");
  }
  std::stable_sort(log.fixes.begin(), log.fixes.end(),
                   [](const NavFix& a, const NavFix& b) { return a.seconds < b.seconds; });
  return log;
}

void Append(const NavLog& next, const std::string& path, NavLog* log) {
  if (next.is_geographic != log->is_geographic || next.is_absolute != log->is_absolute ||
      next.has_height != log->has_height) {
    throw Error(path, "tells other things than the log before it",
                "give logs with the same columns, or one of them");
  }
  if (next.fixes.front().seconds <= log->fixes.back().seconds &&
      log->fixes.front().seconds <= next.fixes.back().seconds) {
    throw Error(path, "overlaps in time with the log before it",
                "give the one whose positions are better");
  }
  log->fixes.insert(log->fixes.end(), next.fixes.begin(), next.fixes.end());
  std::stable_sort(log->fixes.begin(), log->fixes.end(),
                   [](const NavFix& a, const NavFix& b) { return a.seconds < b.seconds; });
}

}  // namespace

NavLog ReadNavLogs(const std::string& paths, const std::string& option) {
  std::istringstream parts(paths);
  NavLog log;
  for (std::string path; std::getline(parts, path, ',');) {
    NavLog next = ReadNavLog(path, option);
    if (log.fixes.empty()) {
      log = std::move(next);
    } else {
      Append(next, path, &log);
    }
  }
  const auto end =
      std::unique(log.fixes.begin(), log.fixes.end(),
                  [](const NavFix& a, const NavFix& b) { return a.seconds == b.seconds; });
  log.fixes.erase(end, log.fixes.end());
  return log;
}

std::vector<PictureTime> ReadPictureTimes(const std::filesystem::path& path,
                                          const std::string& option) {
  const CsvTable table = ReadCsvTable(path, option);
  if (table.header_where.empty()) {
    throw Error(path.string(), "is empty", "write image,time, then one picture a line");
  }
  const Columns columns(table);
  const auto image = columns.Find({"image", "name", "frame", "picture", "file", "filename"});
  const auto time = columns.Find({"timestamp", "datetime", "time", "seconds"});
  if (!image || !time) columns.ThrowMissing("picture or no time", "begin the file with image,time");
  std::vector<PictureTime> times;
  for (const CsvRow& row : table.rows) {
    const auto parsed = ParseClockTime(FieldOf(row, *time));
    if (!parsed) {
      throw Error(row.where, "'" + FieldOf(row, *time) + "' is no time",
                  "write it as 2024-05-01T10:11:12.5, or in seconds");
    }
    if (!times.empty() && parsed->is_absolute != times.front().time.is_absolute) {
      throw Error(row.where, "its time is of another kind than those before it",
                  "write all times with their date, or all in seconds");
    }
    times.push_back({FieldOf(row, *image), *parsed});
  }
  return times;
}

}  // namespace colmap_seapoint
