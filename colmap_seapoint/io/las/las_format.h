// LAS 1.4 (ASPRS, R15), as far as we write it: point format 7, with what a point of ours has beyond
// it as extra bytes. For this room only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "colmap_seapoint/io/cloud/ply_reader.h"

namespace colmap_seapoint {

inline constexpr size_t kLasHeaderBytes = 375;
inline constexpr size_t kLasPointBytes = 30 + 6;  // of format 7, without extra bytes

// What stands in front of the points.
struct LasHeader {
  uint64_t num_points = 0;
  // A point's coordinate is its integer * scale + offset.
  double scale = 1;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();
  std::string crs_wkt;  // empty: none
  bool has_normals = false;
  bool has_confidence = false;
};

// A variable length record: who defined it, as what, and what it holds.
struct LasRecord {
  std::string user;
  uint16_t id = 0;
  std::string description;
  std::vector<char> bytes;
};

std::vector<LasRecord> RecordsOf(const LasHeader& header);
size_t ExtraBytes(const LasHeader& header);
// The header and its records.
std::vector<char> HeaderBytes(const LasHeader& header);

// A point's integers; `xyz` lies within the header's min and max.
std::array<int32_t, 3> Quantized(const LasHeader& header, const Eigen::Vector3d& xyz);
// 16 bits a channel from 8, so that white stays white.
std::array<uint16_t, 3> WideColor(const std::array<uint8_t, 3>& rgb);
// Appends one point: kLasPointBytes + ExtraBytes().
void AppendPoint(const LasHeader& header, const CloudVertex& vertex, const Eigen::Vector3d& xyz,
                 std::vector<char>* bytes);
void AppendExtraBytes(const LasHeader& header, const CloudVertex& vertex, std::vector<char>* bytes);

}  // namespace colmap_seapoint
