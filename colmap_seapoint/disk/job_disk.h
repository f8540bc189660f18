// The disk of a workspace, watched from part to part of its job.
#pragma once

#include "colmap_seapoint/disk/disk_watch.h"
#include "colmap_seapoint/disk/spare_data.h"
#include "colmap_seapoint/estimate/needs.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

class JobDisk {
 public:
  JobDisk(const Workspace& workspace, const JobSize& size, WhenShort when_short);

  // Before the part: DiskWatch::Begin() with what it and those after it write.
  void Begin(JobPart part);

 private:
  const Workspace workspace_;
  const DiskNeeds needs_;
  DiskWatch watch_;
};

}  // namespace colmap_seapoint
