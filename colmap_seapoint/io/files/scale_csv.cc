#include "colmap_seapoint/io/files/scale_csv.h"

#include <charconv>
#include <set>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/csv_table.h"

namespace colmap_seapoint {
namespace {

constexpr char kBarsHeader[] = "name1,name2,length_m";
constexpr char kBarsSigmaHeader[] = "name1,name2,length_m,sigma_m";
constexpr char kTargetsHeader[] = "target,image,x,y";
constexpr char kPointPrefix[] = "point:";

[[noreturn]] void FailHeader(const CsvTable& table, const std::string& header) {
  throw Error(table.header_where, "the header line is '" + table.header_text.substr(0, 80) + "'",
              "begin the file with " + header);
}

void ExpectFields(const CsvRow& row, size_t count, const std::string& header) {
  if (row.fields.size() == count) return;
  throw Error(
      row.where,
      "has " + std::to_string(row.fields.size()) + " fields instead of " + std::to_string(count),
      "write " + header);
}

void ExpectRows(const std::filesystem::path& path, const CsvTable& table, const char* what,
                const std::string& header) {
  if (!table.rows.empty()) return;
  throw Error(path.string(), std::string("holds no ") + what,
              "write " + header + ", then one " + what + " a line");
}

ScaleBarEnd ParseEnd(const CsvRow& row, size_t field) {
  const std::string& name = row.fields[field];
  if (name.empty()) {
    throw Error(row.where, "an end of the bar has no name",
                "write a target's name, or point:ID for a 3D point of the model");
  }
  ScaleBarEnd end{name, std::nullopt};
  if (name.rfind(kPointPrefix, 0) != 0) return end;
  const char* begin = name.data() + std::string(kPointPrefix).size();
  uint64_t id = 0;
  const auto parsed = std::from_chars(begin, name.data() + name.size(), id);
  if (parsed.ec != std::errc() || parsed.ptr != name.data() + name.size()) {
    throw Error(row.where, "'" + name + "' names no 3D point", "write point:ID, e.g. point:1234");
  }
  end.point3D_id = id;
  return end;
}

double PositiveMetres(const CsvRow& row, size_t field, const char* what) {
  const double metres = CsvNumber(row, field, std::string("write the ") + what + " in metres");
  if (metres > 0) return metres;
  throw Error(row.where,
              std::string("the ") + what + " '" + row.fields[field] + "' is not positive",
              std::string("write the ") + what + " in metres");
}

}  // namespace

std::vector<ScaleBar> ReadScaleBarsCsv(const std::filesystem::path& path) {
  const CsvTable table = ReadCsvTable(path, "--scale_bars_path");
  const bool has_sigma = table.header == kBarsSigmaHeader;
  if (!table.header_where.empty() && !has_sigma && table.header != kBarsHeader) {
    FailHeader(table, std::string(kBarsHeader) + " or " + kBarsSigmaHeader);
  }
  ExpectRows(path, table, "scale bar", kBarsSigmaHeader);
  std::vector<ScaleBar> bars;
  for (const CsvRow& row : table.rows) {
    ExpectFields(row, has_sigma ? 4 : 3, has_sigma ? kBarsSigmaHeader : kBarsHeader);
    ScaleBar bar;
    bar.where = row.where;
    for (size_t i = 0; i < 2; ++i) bar.ends[i] = ParseEnd(row, i);
    if (bar.ends[0].name == bar.ends[1].name) {
      throw Error(row.where, "both ends of the bar are " + bar.ends[0].name,
                  "name its two different ends");
    }
    bar.metres = PositiveMetres(row, 2, "length");
    if (has_sigma) bar.sigma = PositiveMetres(row, 3, "sigma");
    bars.push_back(std::move(bar));
  }
  return bars;
}

std::vector<TargetMark> ReadTargetsCsv(const std::filesystem::path& path) {
  const CsvTable table = ReadCsvTable(path, "--targets_path");
  if (!table.header_where.empty() && table.header != kTargetsHeader) {
    FailHeader(table, kTargetsHeader);
  }
  ExpectRows(path, table, "mark", kTargetsHeader);
  std::vector<TargetMark> marks;
  std::set<std::pair<std::string, std::string>> known;
  for (const CsvRow& row : table.rows) {
    ExpectFields(row, 4, kTargetsHeader);
    if (row.fields[0].empty() || row.fields[1].empty()) {
      throw Error(row.where, "names no target or no picture",
                  std::string("write ") + kTargetsHeader);
    }
    TargetMark mark;
    mark.where = row.where;
    mark.target = row.fields[0];
    mark.image = row.fields[1];
    for (size_t i = 0; i < 2; ++i) {
      mark.pixel[static_cast<Eigen::Index>(i)] = CsvNumber(row, 2 + i, "write it in pixels");
    }
    if (!known.emplace(mark.target, mark.image).second) {
      throw Error(row.where, mark.target + " is marked in " + mark.image + " already",
                  "keep one mark a target and picture");
    }
    marks.push_back(std::move(mark));
  }
  return marks;
}

}  // namespace colmap_seapoint
