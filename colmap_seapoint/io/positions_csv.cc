#include "colmap_seapoint/io/positions_csv.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/geodesy.h"

namespace colmap_seapoint {
namespace {

constexpr char kHeaders[] = "image,x,y,z or image,lat,lon,alt";

std::string Trim(const std::string& text) {
  const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
  const auto end = std::find_if_not(text.rbegin(), text.rend(), is_space).base();
  return begin < end ? std::string(begin, end) : std::string();
}

// Commas within double quotes do not separate, and "" is a quote there.
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

bool ParseNumber(std::string text, double* value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.erase(0, 1);
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), *value);
  return parsed.ec == std::errc() && parsed.ptr == text.data() + text.size() &&
         std::isfinite(*value);
}

std::string Lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// One data row; `where` is "<file>:<line>".
void AddRow(const std::string& where, const std::vector<std::string>& fields,
            PicturePositions* result) {
  if (fields.size() != 4) {
    throw Error(where, "has " + std::to_string(fields.size()) + " fields instead of 4",
                "write one picture a line: its name and three numbers");
  }
  if (fields[0].empty()) throw Error(where, "names no picture", "write its name first");
  Eigen::Vector3d position;
  for (size_t i = 0; i < 3; ++i) {
    if (ParseNumber(fields[i + 1], &position[static_cast<Eigen::Index>(i)])) continue;
    throw Error(where, "'" + fields[i + 1] + "' is no finite number",
                "correct it, or leave the line out when the position is unknown");
  }
  if (result->is_geographic && !IsLegal({position.x(), position.y(), position.z()})) {
    throw Error(where, fields[1] + ", " + fields[2] + " is no latitude and longitude in degrees",
                "correct it, or use the header image,x,y,z for metres");
  }
  if (!result->positions.emplace(fields[0], position).second) {
    throw Error(where, fields[0] + " has a position already", "keep one line a picture");
  }
}

}  // namespace

PicturePositions ReadPositionsCsv(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path)) {
    throw Error(path.string(), "there is no such file, or it cannot be read",
                "check --SpatialMatching.positions_path");
  }
  PicturePositions result;
  bool has_header = false;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (number == 1 && line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);  // spreadsheets' mark
    line = Trim(line);
    if (line.empty() || line[0] == '#') continue;
    const std::string where = path.string() + ":" + std::to_string(number);
    const auto fields = SplitFields(line);
    if (has_header) {
      AddRow(where, fields, &result);
      continue;
    }
    const std::string header = [&] {
      std::string joined;
      for (const std::string& field : fields) joined += (joined.empty() ? "" : ",") + Lower(field);
      return joined;
    }();
    result.is_geographic = header == "image,lat,lon,alt";
    if (!result.is_geographic && header != "image,x,y,z") {
      throw Error(where, "the header line is '" + line.substr(0, 80) + "'",
                  std::string("begin the file with ") + kHeaders);
    }
    has_header = true;
  }
  if (stream.bad()) throw Error(path.string(), "cannot be read to its end", "check the disk");
  if (result.positions.empty()) {
    throw Error(path.string(), has_header ? "holds no position" : "is empty",
                std::string("write ") + kHeaders + ", then one line a picture");
  }
  return result;
}

}  // namespace colmap_seapoint
