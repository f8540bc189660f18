// A cloud as LAS or LAZ, which programs of surveying and of maps open.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>

namespace colmap_seapoint {

enum class LasPacking { kNone, kLaz };

struct CloudExport {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // added to the cloud's coordinates
  std::string crs;  // of the shifted coordinates, as WellKnownText() takes it; empty: none
  LasPacking packing = LasPacking::kNone;
};

// What our files name as the system that made them, and nobody else's: see CheckReplaceable().
inline constexpr char kLasWords[] = "colmap_seapoint LAS";

// Whether this build has the library (liblaszip) that packs.
bool CanWriteLaz();

// LAS 1.4, point format 7: positions as integers of a ten-millionth of the extent or more, below
// a millionth, colours of 16 bits, the reference system as well-known text, and normals and
// confidence, where the cloud has them, as extra bytes (NormalX, NormalY, NormalZ, Confidence;
// float). `from` is any PLY that CloudReader reads; it is read twice, and memory does not grow with
// it. Atomic. Returns the number of points. The same bytes each time. Throws Error: as CloudReader
// does, for a reference system that PROJ does not know, for LAZ without the library, when `to`
// cannot be written.
uint64_t ExportCloud(const std::filesystem::path& from, const std::filesystem::path& to,
                     const CloudExport& options);

}  // namespace colmap_seapoint
