// MapMemory on the disk. Ours alone: whoever reads it knows its hash.
#pragma once

#include <filesystem>

#include "colmap_seapoint/orthomosaic/map_memory.h"

namespace colmap_seapoint {

// Atomic. Throws Error.
void WriteMapMemory(const std::filesystem::path& path, const MapMemory& memory);
// Throws Error for a file that is not what WriteMapMemory wrote.
MapMemory ReadMapMemory(const std::filesystem::path& path);

}  // namespace colmap_seapoint
