#include "colmap_seapoint/io/cloud/ply_header.h"

#include <map>
#include <optional>
#include <sstream>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr int kMaxHeaderLines = 10000;
constexpr size_t kMaxLineBytes = 4096;
constexpr const char* kRemedy = "save the cloud again as binary or ASCII PLY";

std::optional<PlyType> FindType(const std::string& name) {
  static const std::map<std::string, PlyType> kTypes = {
      {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUInt8},
      {"uint8", PlyType::kUInt8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUInt16},  {"uint16", PlyType::kUInt16},   {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},    {"uint", PlyType::kUInt32},     {"uint32", PlyType::kUInt32},
      {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
      {"float64", PlyType::kFloat64}};
  const auto found = kTypes.find(name);
  return found == kTypes.end() ? std::nullopt : std::make_optional(found->second);
}

// A header line; a binary file without line ends must not be swallowed whole.
bool ReadLine(std::istream* stream, std::string* line) {
  line->clear();
  for (char c; stream->get(c);) {
    if (c == '\n') {
      if (!line->empty() && line->back() == '\r') line->pop_back();
      return true;
    }
    line->push_back(c);
    if (line->size() > kMaxLineBytes) return false;
  }
  return false;
}

bool ParseProperty(std::istringstream* words, PlyProperty* property) {
  std::string type;
  *words >> type;
  if (type == "list") {
    std::string count_type;
    *words >> count_type >> type;
    const auto count = FindType(count_type);
    if (!count || *count == PlyType::kFloat32 || *count == PlyType::kFloat64) return false;
    property->is_list = true;
    property->count_type = *count;
  }
  const auto found = FindType(type);
  if (!found || !(*words >> property->name)) return false;
  property->type = *found;
  return true;
}

bool ParseElement(std::istringstream* words, PlyElement* element) {
  std::string count;
  if (!(*words >> element->name >> count) || count.size() > 18) return false;
  if (count.find_first_not_of("0123456789") != std::string::npos) return false;
  element->count = std::stoull(count);
  return true;
}

// False when the line is no legal header line.
bool ParseLine(const std::string& line, PlyHeader* header, bool* has_format) {
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  if (keyword.empty() || keyword == "comment" || keyword == "obj_info") return true;
  if (keyword == "format") {
    std::string format, version;
    words >> format >> version;
    header->is_ascii = format == "ascii";
    header->is_big_endian = format == "binary_big_endian";
    *has_format = header->is_ascii || header->is_big_endian || format == "binary_little_endian";
    return *has_format && version == "1.0";
  }
  if (keyword == "element") {
    header->elements.emplace_back();
    return ParseElement(&words, &header->elements.back());
  }
  if (keyword == "property" && !header->elements.empty()) {
    auto& properties = header->elements.back().properties;
    properties.emplace_back();
    return ParseProperty(&words, &properties.back());
  }
  return false;
}

}  // namespace

size_t PlyTypeBytes(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUInt8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUInt16:
      return 2;
    case PlyType::kFloat64:
      return 8;
    default:
      return 4;
  }
}

size_t PlyElement::MinRowBytes() const {
  size_t bytes = 0;
  for (const PlyProperty& property : properties) {
    bytes += PlyTypeBytes(property.is_list ? property.count_type : property.type);
  }
  return bytes;
}

bool PlyElement::HasLists() const {
  for (const PlyProperty& property : properties) {
    if (property.is_list) return true;
  }
  return false;
}

int PlyElement::Find(const std::string& property) const {
  for (size_t i = 0; i < properties.size(); ++i) {
    if (properties[i].name == property && !properties[i].is_list) return static_cast<int>(i);
  }
  return -1;
}

PlyHeader ReadPlyHeader(const std::string& path, std::istream* stream) {
  PlyHeader header;
  bool has_format = false;
  std::string line;
  if (!ReadLine(stream, &line) || line != "ply") throw Error(path, "is not a PLY file", kRemedy);
  for (int number = 2; number < kMaxHeaderLines; ++number) {
    if (!ReadLine(stream, &line)) break;
    if (line == "end_header") {
      if (!has_format) throw Error(path, "the PLY header names no format", kRemedy);
      return header;
    }
    if (!ParseLine(line, &header, &has_format)) {
      throw Error(path,
                  "line " + std::to_string(number) + " of the PLY header cannot be used: '" +
                      line.substr(0, 60) + "'",
                  kRemedy);
    }
  }
  throw Error(path, "the PLY header does not end", kRemedy);
}

}  // namespace colmap_seapoint
