#include "colmap_seapoint/io/files/positions_csv.h"

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/geodesy.h"
#include "colmap_seapoint/io/files/csv_table.h"

namespace colmap_seapoint {
namespace {

constexpr char kHeaders[] = "image,x,y,z or image,lat,lon,alt or image,lat,lon,depth";
constexpr char kMetres[] = "image,x,y,z";
constexpr char kAltitude[] = "image,lat,lon,alt";
constexpr char kDepth[] = "image,lat,lon,depth";

struct Columns {
  bool is_geographic = false;
  bool is_depth = false;
  size_t num_sigmas = 0;
};

Columns ParseHeader(const CsvTable& table) {
  for (const char* base : {kMetres, kAltitude, kDepth}) {
    if (table.header.rfind(base, 0) != 0) continue;
    const std::string rest = table.header.substr(std::string(base).size());
    if (!rest.empty() && rest != ",sigma" && rest != ",sigma_xy,sigma_z") continue;
    return {base != kMetres, base == kDepth, rest.empty() ? 0u : rest == ",sigma" ? 1u : 2u};
  }
  throw Error(table.header_where, "the header line is '" + table.header_text.substr(0, 80) + "'",
              std::string("begin the file with ") + kHeaders);
}

Eigen::Vector3d ParseSigmas(const CsvRow& row, size_t num_sigmas) {
  Eigen::Vector3d sigmas;
  for (size_t i = 0; i < num_sigmas; ++i) {
    const double sigma = CsvNumber(row, 4 + i, "write it in metres");
    if (!(sigma > 0)) {
      throw Error(row.where, "the sigma '" + row.fields[4 + i] + "' is not positive",
                  "write the position's standard deviation in metres");
    }
    if (i == 0) sigmas.setConstant(sigma);
    sigmas.z() = sigma;
  }
  return sigmas;
}

void AddRow(const CsvRow& row, const Columns& columns, PicturePositions* result) {
  const auto& fields = row.fields;
  const size_t num_fields = 4 + columns.num_sigmas;
  if (fields.size() != num_fields) {
    throw Error(
        row.where,
        "has " + std::to_string(fields.size()) + " fields instead of " + std::to_string(num_fields),
        "write one picture a line: its name and the numbers of the header");
  }
  if (fields[0].empty()) throw Error(row.where, "names no picture", "write its name first");
  Eigen::Vector3d position;
  for (size_t i = 0; i < 3; ++i) {
    position[static_cast<Eigen::Index>(i)] =
        CsvNumber(row, i + 1, "correct it, or leave the line out when the position is unknown");
  }
  if (columns.is_depth) position.z() = -position.z();
  if (result->is_geographic && !IsLegal({position.x(), position.y(), position.z()})) {
    throw Error(row.where,
                fields[1] + ", " + fields[2] + " is no latitude and longitude in degrees",
                "correct it, or use the header image,x,y,z for metres");
  }
  if (columns.num_sigmas > 0) result->sigmas[fields[0]] = ParseSigmas(row, columns.num_sigmas);
  if (!result->positions.emplace(fields[0], position).second) {
    throw Error(row.where, fields[0] + " has a position already", "keep one line a picture");
  }
}

}  // namespace

PicturePositions ReadPositionsCsv(const std::filesystem::path& path, const std::string& option) {
  const CsvTable table = ReadCsvTable(path, option);
  PicturePositions result;
  if (!table.header_where.empty()) {
    const Columns columns = ParseHeader(table);
    result.is_geographic = columns.is_geographic;
    for (const CsvRow& row : table.rows) AddRow(row, columns, &result);
  }
  if (result.positions.empty()) {
    throw Error(path.string(), table.header_where.empty() ? "is empty" : "holds no position",
                std::string("write ") + kHeaders + ", then one line a picture");
  }
  return result;
}

}  // namespace colmap_seapoint
