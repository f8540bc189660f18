// Tables that a user brings, separated by commas, semicolons or tabs: navigation logs, scale bars,
// marked targets.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace colmap_seapoint {

struct CsvRow {
  std::string where;                // "<file>:<line>", for messages
  std::vector<std::string> fields;  // without blanks around them
};

struct CsvTable {
  std::string header;        // the fields of the first row, joined by commas, in small letters
  std::string header_where;  // "<file>:<line>"; empty: there is no row at all
  std::string header_text;   // as it stands there
  std::vector<CsvRow> rows;  // after the header
};

// The header says what separates the fields: commas, else semicolons or tabs; a comma in a number
// is a decimal one then. Fields with a separator stand in double quotes ("" is a quote there);
// blank lines and lines that start with '#' are skipped, as is the mark that spreadsheets put in
// front. Throws Error when the file cannot be read; `option` is the one to check.
CsvTable ReadCsvTable(const std::filesystem::path& path, const std::string& option);

// The text as a field of such a table: in quotes where it holds a comma or a quote.
std::string CsvField(const std::string& text);

// A finite number, with a point; false for anything else.
bool ParseCsvNumber(std::string text, double* value);

// Throws Error "<where>: '<text>' is no finite number".
double CsvNumber(const CsvRow& row, size_t field, const std::string& remedy);

}  // namespace colmap_seapoint
