// The file system that a path lies on, and what of it may still be filled.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace colmap_seapoint {

// All of `path`, which need not be there yet: the nearest folder above it that is there tells.

// Bytes that this user may still fill; nullopt: the system does not tell. Where the environment
// variable SEAPOINT_FREE_DISK names a file, the number that this file holds.
std::optional<uint64_t> FreeDiskBytes(const std::filesystem::path& path);

struct FileSystem {
  dev_t device = 0;
  std::filesystem::path mount_point;  // as people know it
};
FileSystem FileSystemOf(const std::filesystem::path& path);

}  // namespace colmap_seapoint
