#include "colmap_seapoint/io/files/csv_table.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

std::string Trim(const std::string& text) {
  const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
  const auto end = std::find_if_not(text.rbegin(), text.rend(), is_space).base();
  return begin < end ? std::string(begin, end) : std::string();
}

// What the fields of a table are separated by: commas; semicolons or tabs where these come first in
// its header, as spreadsheets of countries that write decimal commas have it.
char SeparatorOf(const std::string& header) {
  std::string bare;
  bool is_quoted = false;
  for (const char c : header) {
    if (c == '"') is_quoted = !is_quoted;
    if (!is_quoted) bare += c;
  }
  for (const char separator : {';', '\t'}) {
    const bool comes_first = bare.find(separator) < bare.find(',');
    if (comes_first) return separator;
  }
  return ',';
}

// Where no comma separates, one in a number or a time is a decimal one.
void MendDecimalComma(std::string* field) {
  const size_t comma = field->find(',');
  if (comma == std::string::npos || comma == 0 || comma + 1 == field->size()) return;
  const auto is_digit = [&](size_t i) {
    return std::isdigit(static_cast<unsigned char>((*field)[i])) != 0;
  };
  const bool is_number = field->find_first_not_of("0123456789+-.,:/ eETZ") == std::string::npos;
  if (is_number && field->rfind(',') == comma && is_digit(comma - 1) && is_digit(comma + 1)) {
    (*field)[comma] = '.';
  }
}

std::vector<std::string> SplitFields(const std::string& line, char separator) {
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (line[i] == '"') {
      is_quoted = !is_quoted;
    } else if (line[i] == separator && !is_quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  for (std::string& field : fields) {
    field = Trim(field);
    if (separator != ',') MendDecimalComma(&field);
  }
  return fields;
}

std::string Lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

std::string CsvField(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

bool ParseCsvNumber(std::string text, double* value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.erase(0, 1);
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), *value);
  return parsed.ec == std::errc() && parsed.ptr == text.data() + text.size() &&
         std::isfinite(*value);
}

double CsvNumber(const CsvRow& row, size_t field, const std::string& remedy) {
  double value = 0;
  if (ParseCsvNumber(row.fields.at(field), &value)) return value;
  throw Error(row.where, "'" + row.fields[field] + "' is no finite number", remedy);
}

CsvTable ReadCsvTable(const std::filesystem::path& path, const std::string& option) {
  const std::unique_ptr<InputStream> stream = OpenIfThere(path);
  if (stream == nullptr) throw Error(path.string(), "there is no such file", "check " + option);
  CsvTable table;
  std::string line;
  char separator = ',';
  for (int number = 1; std::getline(*stream, line); ++number) {
    if (number == 1 && line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);
    const std::string text = Trim(line);
    if (text.empty() || text[0] == '#') continue;
    const std::string where = path.string() + ":" + std::to_string(number);
    if (table.header_where.empty()) separator = SeparatorOf(line);
    std::vector<std::string> fields = SplitFields(line, separator);
    if (!table.header_where.empty()) {
      table.rows.push_back({where, std::move(fields)});
      continue;
    }
    table.header_where = where;
    table.header_text = text;
    for (std::string& field : fields) {
      field.erase(std::remove(field.begin(), field.end(), ','), field.end());
      table.header += (table.header.empty() ? "" : ",") + Lower(field);
    }
  }
  return table;
}

}  // namespace colmap_seapoint
