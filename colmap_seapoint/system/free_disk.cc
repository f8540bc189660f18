#include "colmap_seapoint/system/free_disk.h"

#include <sys/stat.h>
#include <sys/statvfs.h>

#include <cstdlib>
#include <fstream>
#include <system_error>

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Absolute, links followed.
fs::path NearestThatIsThere(const fs::path& path) {
  std::error_code error;
  fs::path there = fs::absolute(path, error);
  while (!fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  const fs::path canonical = fs::canonical(there, error);
  return error ? there : canonical;
}

// 0 where the system does not tell.
dev_t DeviceOf(const fs::path& path) {
  struct stat status {};
  return stat(path.c_str(), &status) == 0 ? status.st_dev : 0;
}

}  // namespace

std::optional<uint64_t> FreeDiskBytes(const fs::path& path) {
  if (const char* told = std::getenv("SEAPOINT_FREE_DISK")) {
    uint64_t bytes = 0;
    if (std::ifstream(told) >> bytes) return bytes;
    return std::nullopt;
  }
  struct statvfs disk {};
  if (statvfs(NearestThatIsThere(path).c_str(), &disk) != 0) return std::nullopt;
  return static_cast<uint64_t>(disk.f_bavail) * disk.f_frsize;
}

FileSystem FileSystemOf(const fs::path& path) {
  FileSystem found;
  found.mount_point = NearestThatIsThere(path);
  found.device = DeviceOf(found.mount_point);
  while (found.mount_point.has_relative_path() &&
         DeviceOf(found.mount_point.parent_path()) == found.device) {
    found.mount_point = found.mount_point.parent_path();
  }
  return found;
}

}  // namespace colmap_seapoint
