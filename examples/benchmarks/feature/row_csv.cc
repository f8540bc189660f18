#include "examples/benchmarks/feature/row_csv.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

constexpr char kRemedy[] = "remove the file and measure the set again";

CsvFields Split(const std::string& line) {
  CsvFields fields(1);
  for (char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

}  // namespace

std::string SafeName(std::string name) {
  for (char& c : name) {
    if (c == ',' || c == '"' || c == '|' || static_cast<unsigned char>(c) < 32) c = '_';
  }
  return name;
}

std::string CsvLine(const CsvFields& fields) {
  std::string line;
  for (const std::string& field : fields) line += field + ",";
  line.back() = '\n';
  return line;
}

std::string CsvNumber(double value) {
  if (std::isnan(value)) return "";
  char number[32];
  std::snprintf(number, sizeof(number), "%.6g", value);
  return number;
}

double ParseCsvNumber(const std::filesystem::path& path, const std::string& text) {
  if (text.empty()) return kNotMeasured;
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (*end != '\0' || !std::isfinite(value)) {
    throw Error(path.string(), "'" + text + "' is no number", kRemedy);
  }
  return value;
}

std::vector<CsvFields> ReadCsv(const std::filesystem::path& path, const CsvFields& header) {
  std::ifstream file(path);
  std::string line;
  if (!file || !std::getline(file, line)) throw Error(path.string(), "cannot be read", kRemedy);
  if (line + "\n" != CsvLine(header)) throw Error(path.string(), "has other columns", kRemedy);
  std::vector<CsvFields> lines;
  while (std::getline(file, line)) {
    lines.push_back(Split(line));
    if (lines.back().size() != header.size()) {
      throw Error(path.string(), "line " + std::to_string(lines.size() + 1) + " is damaged",
                  kRemedy);
    }
  }
  return lines;
}

void WriteCsv(const std::filesystem::path& path, const std::vector<CsvFields>& lines) {
  std::string text;
  for (const CsvFields& fields : lines) text += CsvLine(fields);
  WriteTextFile(path, text);
}

}  // namespace colmap_seapoint
