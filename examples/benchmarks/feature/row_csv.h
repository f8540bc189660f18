// Plain rows of text and numbers as CSV, one binding of the columns for both ways.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace colmap_seapoint {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

// Commas, quotes, bars and control characters in names become '_', here and in the Markdown.
std::string SafeName(std::string name);

// Texts come first in the file; kNotMeasured is an empty field.
template <typename Row>
struct RowColumns {
  std::vector<std::pair<const char*, std::string Row::*>> texts;
  std::vector<std::pair<const char*, double Row::*>> numbers;
};

// The fields of one line.
using CsvFields = std::vector<std::string>;

std::string CsvLine(const CsvFields& fields);
std::string CsvNumber(double value);
// Throws Error for what is no finite number.
double ParseCsvNumber(const std::filesystem::path& path, const std::string& text);
// All lines below the header. Throws Error for a missing file, another header and lines with
// another number of fields.
std::vector<CsvFields> ReadCsv(const std::filesystem::path& path, const CsvFields& header);
void WriteCsv(const std::filesystem::path& path, const std::vector<CsvFields>& lines);

template <typename Row>
CsvFields CsvHeader(const RowColumns<Row>& columns) {
  CsvFields header;
  for (const auto& column : columns.texts) header.emplace_back(column.first);
  for (const auto& column : columns.numbers) header.emplace_back(column.first);
  return header;
}

template <typename Row>
void WriteRows(const std::filesystem::path& path, const RowColumns<Row>& columns,
               const std::vector<Row>& rows) {
  std::vector<CsvFields> lines = {CsvHeader(columns)};
  for (const Row& row : rows) {
    lines.emplace_back();
    for (const auto& column : columns.texts) lines.back().push_back(SafeName(row.*column.second));
    for (const auto& column : columns.numbers) {
      lines.back().push_back(CsvNumber(row.*column.second));
    }
  }
  WriteCsv(path, lines);
}

// Throws Error for a missing file and for anything WriteRows does not write.
template <typename Row>
std::vector<Row> ReadRows(const std::filesystem::path& path, const RowColumns<Row>& columns) {
  std::vector<Row> rows;
  for (const CsvFields& fields : ReadCsv(path, CsvHeader(columns))) {
    Row row;
    auto field = fields.begin();
    for (const auto& column : columns.texts) row.*column.second = *field++;
    for (const auto& column : columns.numbers) {
      row.*column.second = ParseCsvNumber(path, *field++);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace colmap_seapoint
