// A cloud (or mesh) moved by a similarity, as it streams from one file into another.
#pragma once

#include <cstdint>
#include <filesystem>

#include "colmap_seapoint/base/similarity3.h"

namespace colmap_seapoint {

// Positions and normals (unit again) of the vertices of any binary_little_endian or ASCII PLY with
// float or double x y z; every other property and element keeps its bytes (words). `from`.vis, if
// there is one, is copied to `to`.vis. Both appear whole or not at all. Returns the number of
// vertices. Throws Error when `from` is no such file or truncated, when vertices are not its first
// element or have lists, or when `to` cannot be written. Memory does not grow with the cloud.
uint64_t TransformCloud(const std::filesystem::path& from, const std::filesystem::path& to,
                        const Similarity3d& new_from_old);

}  // namespace colmap_seapoint
