#include "colmap_seapoint/disk/disk_finding.h"

#include <algorithm>
#include <map>

#include "colmap_seapoint/system/free_disk.h"
#include "colmap_seapoint/system/memory_limit.h"

namespace colmap_seapoint {
namespace {

// What of it is there already. What goes beyond the estimate says nothing of other parts.
uint64_t BytesThere(const DiskNeed& need) {
  uint64_t bytes = 0;
  for (const std::filesystem::path& place : need.places) bytes += FolderBytes(place);
  return std::min(bytes, need.bytes);
}

DiskFinding Judge(const std::filesystem::path& mount_point, uint64_t free_bytes,
                  const std::vector<const DiskNeed*>& to_come) {
  DiskFinding finding;
  finding.mount_point = mount_point;
  finding.free_bytes = free_bytes;
  Needs all;
  for (const DiskNeed* need : to_come) all.disk_bytes += need->bytes;
  finding.needed_bytes = all.disk_bytes;
  if (free_bytes >= all.disk_bytes) return finding;
  Supply supply = {free_bytes, 0, 0};
  for (const DiskNeed* need : to_come) supply.workspace_bytes += BytesThere(*need);
  finding.needed_bytes -= supply.workspace_bytes;
  finding.verdict = JudgeDisk(all, supply);
  return finding;
}

}  // namespace

std::string TextOf(const DiskFinding& finding) {
  return finding.mount_point.string() + ": has " + BytesText(finding.free_bytes) +
         " free, and what is left of this job takes up to " + BytesText(finding.needed_bytes) +
         "; make room on this disk, choose a --workspace_path on another one, or take fewer points "
         "by a larger --PartialDensification.step";
}

DiskFinding ShortestDisk(const std::vector<DiskNeed>& to_come) {
  std::map<dev_t, std::vector<const DiskNeed*>> by_device;
  for (const DiskNeed& need : to_come) {
    by_device[FileSystemOf(need.places.front()).device].push_back(&need);
  }
  DiskFinding shortest;
  for (const auto& [device, needs] : by_device) {
    const std::filesystem::path& place = needs.front()->places.front();
    const auto free_bytes = FreeDiskBytes(place);
    if (!free_bytes) continue;
    const DiskFinding finding = Judge(FileSystemOf(place).mount_point, *free_bytes, needs);
    if (finding.verdict > shortest.verdict) shortest = finding;
  }
  return shortest;
}

}  // namespace colmap_seapoint
