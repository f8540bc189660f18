// A cloud of ours, and which two pictures each point is from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "colmap_seapoint/io/cloud/ply.h"

namespace colmap_seapoint {

// Calls visit(point, image_idx1, image_idx2) for each point, in the file's order; places in
// images.bin. Streams `path` and `path`.vis. Throws Error as CloudReader does, and for a .vis that
// is not the cloud's, or where a point is not of two pictures.
void ReadSeenCloud(const std::filesystem::path& path,
                   const std::function<void(const CloudPoint&, uint32_t, uint32_t)>& visit);

}  // namespace colmap_seapoint
