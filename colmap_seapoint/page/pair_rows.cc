#include "colmap_seapoint/page/pair_rows.h"

#include <array>
#include <sstream>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/csv_table.h"

namespace colmap_seapoint {
namespace {

constexpr char kRemedy[] = "let partial_densifier write it again, or move it away";

// Where the columns stand that are shown.
std::array<size_t, 5> ColumnsOf(const CsvTable& table, const std::filesystem::path& path) {
  const std::array<const char*, 5> names = {"image1", "image2", "overlap", "num_points", "skipped"};
  std::array<size_t, 5> columns;
  columns.fill(std::string::npos);
  std::istringstream header(table.header);
  std::string name;
  for (size_t at = 0; std::getline(header, name, ','); ++at) {
    for (size_t k = 0; k < names.size(); ++k) {
      if (name == names[k]) columns[k] = at;
    }
  }
  for (size_t k = 0; k < names.size(); ++k) {
    if (columns[k] != std::string::npos) continue;
    throw Error(path.string(), std::string("has no column ") + names[k], kRemedy);
  }
  return columns;
}

}  // namespace

std::vector<PairRow> ReadPairRows(const std::filesystem::path& path) {
  std::vector<PairRow> pairs;
  if (!std::filesystem::exists(path)) return pairs;
  const CsvTable table = ReadCsvTable(path, "--cloud_path");
  const std::array<size_t, 5> columns = ColumnsOf(table, path);
  for (const CsvRow& row : table.rows) {
    for (const size_t column : columns) {
      if (column >= row.fields.size()) throw Error(row.where, "is no whole row", kRemedy);
    }
    PairRow& pair = pairs.emplace_back();
    pair.image1 = row.fields[columns[0]];
    pair.image2 = row.fields[columns[1]];
    pair.overlap = CsvNumber(row, columns[2], kRemedy);
    pair.num_points = CsvNumber(row, columns[3], kRemedy);
    pair.skipped = row.fields[columns[4]];
  }
  return pairs;
}

}  // namespace colmap_seapoint
