#include "tests/benchmark/feature_rows.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/atomic_file.h"

namespace colmap_seapoint {
namespace {

constexpr char kRemedy[] = "remove the file and measure the set again";

struct TextColumn {
  const char* name;
  std::string FeatureRow::*field;
};
struct NumberColumn {
  const char* name;
  double FeatureRow::*field;
};

constexpr TextColumn kTextColumns[] = {{"set", &FeatureRow::set},
                                       {"detector", &FeatureRow::detector},
                                       {"setting", &FeatureRow::setting},
                                       {"picture1", &FeatureRow::picture1},
                                       {"picture2", &FeatureRow::picture2}};
constexpr NumberColumn kNumberColumns[] = {{"gap", &FeatureRow::gap},
                                           {"points1", &FeatureRow::points1},
                                           {"points2", &FeatureRow::points2},
                                           {"matches", &FeatureRow::matches},
                                           {"matched_share", &FeatureRow::matched_share},
                                           {"verified", &FeatureRow::verified},
                                           {"verified_share", &FeatureRow::verified_share},
                                           {"reliable_area", &FeatureRow::reliable_area},
                                           {"extract_cpu_s_1", &FeatureRow::extract_cpu1},
                                           {"extract_cpu_s_2", &FeatureRow::extract_cpu2},
                                           {"match_cpu_s", &FeatureRow::match_cpu},
                                           {"texture_limit", &FeatureRow::texture_limit},
                                           {"precision", &FeatureRow::precision},
                                           {"repeatability", &FeatureRow::repeatability},
                                           {"true_overlap", &FeatureRow::true_overlap},
                                           {"overlap_error", &FeatureRow::overlap_error},
                                           {"textured", &FeatureRow::textured},
                                           {"recall", &FeatureRow::recall},
                                           {"area_precision", &FeatureRow::area_precision}};

std::string Header() {
  std::string line;
  for (const TextColumn& column : kTextColumns) line += std::string(column.name) + ",";
  for (const NumberColumn& column : kNumberColumns) line += std::string(column.name) + ",";
  line.back() = '\n';
  return line;
}

std::vector<std::string> Split(const std::string& line) {
  std::vector<std::string> fields(1);
  for (char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

double ParseNumber(const std::filesystem::path& path, const std::string& text) {
  if (text.empty()) return kNotMeasured;
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (*end != '\0' || !std::isfinite(value)) {
    throw Error(path.string(), "'" + text + "' is no number", kRemedy);
  }
  return value;
}

}  // namespace

std::string SafeName(std::string name) {
  for (char& c : name) {
    if (c == ',' || c == '"' || c == '|' || static_cast<unsigned char>(c) < 32) c = '_';
  }
  return name;
}

void WriteFeatureRows(const std::filesystem::path& path, const std::vector<FeatureRow>& rows) {
  std::string text = Header();
  for (const FeatureRow& row : rows) {
    for (const TextColumn& column : kTextColumns) text += SafeName(row.*column.field) + ",";
    for (const NumberColumn& column : kNumberColumns) {
      char number[32] = "";
      const double value = row.*column.field;
      if (!std::isnan(value)) std::snprintf(number, sizeof(number), "%.6g", value);
      text += std::string(number) + ",";
    }
    text.back() = '\n';
  }
  WriteTextFile(path, text);
}

std::vector<FeatureRow> ReadFeatureRows(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  if (!file || !std::getline(file, line)) throw Error(path.string(), "cannot be read", kRemedy);
  if (line + "\n" != Header()) throw Error(path.string(), "has other columns", kRemedy);
  std::vector<FeatureRow> rows;
  while (std::getline(file, line)) {
    const std::vector<std::string> fields = Split(line);
    if (fields.size() != std::size(kTextColumns) + std::size(kNumberColumns)) {
      throw Error(path.string(), "line " + std::to_string(rows.size() + 2) + " is damaged",
                  kRemedy);
    }
    FeatureRow row;
    size_t i = 0;
    for (const TextColumn& column : kTextColumns) row.*column.field = fields[i++];
    for (const NumberColumn& column : kNumberColumns) {
      row.*column.field = ParseNumber(path, fields[i++]);
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace colmap_seapoint
