// What a job needs of the machine, told before it begins (ours).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "colmap_seapoint/estimate/work_costs.h"

namespace colmap_seapoint {

// Of the workspace when all is done, and of what is made meanwhile, by what takes it.
struct DiskNeeds {
  uint64_t database_bytes = 0, model_bytes = 0, cloud_bytes = 0, map_bytes = 0;
};
DiskNeeds ExpectedDiskNeeds(const JobSize& size);

struct Needs {
  uint64_t disk_bytes = 0;    // all of DiskNeeds
  uint64_t memory_bytes = 0;  // at most at a time, the mapper included
};

// From the sizes of workspaces and processes that were measured: what a survey of little overlap
// takes; one of much takes a third of the disk.
Needs ExpectedNeeds(const JobSize& size);

struct Supply {
  std::optional<uint64_t> disk_bytes;  // that this user may still fill; unset: nobody knows
  uint64_t workspace_bytes = 0;        // that an earlier run has filled there already
  uint64_t memory_bytes = 0;           // that the job may take
};

// Of all files below it, or of the file itself; 0 when there is no such thing. What others remove
// meanwhile does not count, and hides nothing else. Links in it are not followed.
uint64_t FolderBytes(const std::filesystem::path& path);

// Two lines: "12 pictures, 17 megapixels; disk: 240.0 MB of 15.0 GB free; memory: 230.0 MB of 3.0
// GB" and "About 6.1 s: SeaPoints 0.1 s, matching 0.5 s, mapping 2.4 s, cloud 2.2 s".
std::string NeedsText(const JobSize& size, const Needs& needs, const Supply& supply);
std::string TimesText(const OfWork<WorkCost>& costs, const OfWork<bool>& done_before,
                      double seconds_left);

enum class DiskVerdict {
  kEnough,
  kMayBeFilled,  // less than is expected
  kTooSmall,     // even where a job takes the least of what such jobs took
};
DiskVerdict JudgeDisk(const Needs& needs, const Supply& supply);

}  // namespace colmap_seapoint
