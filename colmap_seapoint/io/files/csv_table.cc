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

std::vector<std::string> SplitFields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[++i];
    } else if (line[i] == '"') {
      is_quoted = !is_quoted;
    } else if (line[i] == ',' && !is_quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  for (std::string& field : fields) field = Trim(field);
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
  for (int number = 1; std::getline(*stream, line); ++number) {
    if (number == 1 && line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);
    line = Trim(line);
    if (line.empty() || line[0] == '#') continue;
    const std::string where = path.string() + ":" + std::to_string(number);
    std::vector<std::string> fields = SplitFields(line);
    if (!table.header_where.empty()) {
      table.rows.push_back({where, std::move(fields)});
      continue;
    }
    table.header_where = where;
    table.header_text = line;
    for (const std::string& field : fields) {
      table.header += (table.header.empty() ? "" : ",") + Lower(field);
    }
  }
  return table;
}

}  // namespace colmap_seapoint
