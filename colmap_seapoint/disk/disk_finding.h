// Whether there is room for what is still to be written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/estimate/needs.h"

namespace colmap_seapoint {

// What a part of a job takes, and where.
struct DiskNeed {
  std::vector<std::filesystem::path> places;  // files and folders; all where the first one is
  uint64_t bytes = 0;                         // that they will hold together, by an estimate
};

struct DiskFinding {
  std::filesystem::path mount_point;  // of the file system
  DiskVerdict verdict = DiskVerdict::kEnough;
  uint64_t free_bytes = 0;
  uint64_t needed_bytes = 0;  // still to be written
};

// "/media/usb: has 40.0 MB free, and what is left of this job takes up to 160.0 MB; make room ..."
std::string TextOf(const DiskFinding& finding);

// Of the file systems that the places lie on the one that is shortest of room; each is judged by
// all that is to come there, less what its places hold already. One that does not tell what is free
// counts as large enough. Cost: some system calls; where a file system is short, a walk of the
// places.
DiskFinding ShortestDisk(const std::vector<DiskNeed>& to_come);

}  // namespace colmap_seapoint
