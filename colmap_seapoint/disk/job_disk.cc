#include "colmap_seapoint/disk/job_disk.h"

#include <string>
#include <utility>
#include <vector>

namespace colmap_seapoint {
namespace {

// From the part on.
std::vector<DiskNeed> ToCome(const Workspace& workspace, const DiskNeeds& needs, JobPart part) {
  const std::string database = workspace.database.string(), sparse = workspace.sparse.string();
  const std::pair<JobPart, DiskNeed> of_parts[] = {
      {JobPart::kDatabase,
       {{database, database + "-wal", database + ".tmp"}, needs.database_bytes}},
      {JobPart::kModels,
       {{sparse, sparse + ".tmp", sparse + ".tmp.db", workspace.scaled}, needs.model_bytes}},
      {JobPart::kClouds, {{workspace.dense}, needs.cloud_bytes}},
      {JobPart::kMaps, {{workspace.maps}, needs.map_bytes}}};
  std::vector<DiskNeed> to_come;
  for (const auto& [of_part, need] : of_parts) {
    if (of_part >= part) to_come.push_back(need);
  }
  return to_come;
}

}  // namespace

JobDisk::JobDisk(const Workspace& workspace, const JobSize& size, WhenShort when_short)
    : workspace_(workspace), needs_(ExpectedDiskNeeds(size)), watch_(when_short) {}

void JobDisk::Begin(JobPart part) {
  watch_.Begin(ToCome(workspace_, needs_, part), SpareDataOf(workspace_, part));
}

}  // namespace colmap_seapoint
