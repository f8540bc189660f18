// The header of a PLY file, and what its positions may be. For this room only.
#pragma once

#include <cstdint>
#include <istream>
#include <string>
#include <vector>

namespace colmap_seapoint {

enum class PlyType { kInt8, kUInt8, kInt16, kUInt16, kInt32, kUInt32, kFloat32, kFloat64 };

// No position may lie farther out. Beyond it a double has no digits left behind the point, and a
// cell's number does not fit into 64 bits: such values are no places, but what was left of a
// damaged or unset one.
inline constexpr double kMaxCoordinate = 1e15;

size_t PlyTypeBytes(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUInt8;  // of lists
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;

  // Bytes of a row in the binary form, each list counted as an empty one.
  size_t MinRowBytes() const;
  bool HasLists() const;
  int Find(const std::string& property) const;  // -1 when it is not there
};

struct PlyHeader {
  bool is_ascii = false;
  bool is_big_endian = false;
  std::vector<PlyElement> elements;
};

// Reads up to and with "end_header". Throws Error naming `path` and the line.
PlyHeader ReadPlyHeader(const std::string& path, std::istream* stream);

}  // namespace colmap_seapoint
