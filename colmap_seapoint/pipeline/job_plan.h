// What automatic_reconstructor says before it begins: how large the job is, whether the machine can
// hold it, how long it will take; and the one estimate that goes with it from there on.
#pragma once

#include <vector>

#include "colmap_seapoint/estimate/job_progress.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "colmap_seapoint/pipeline/reconstruct_options.h"
#include "colmap_seapoint/pipeline/stage_runner.h"
#include "colmap_seapoint/pipeline/workspace.h"

namespace colmap_seapoint {

// `database`: the stage that the workspace's database is begun with, which tells whether an earlier
// run's work is still of use. Throws Error when the disk is too small by far, unless check_disk is
// 0; says so when it may be.
JobEstimate PlanJob(const AutomaticReconstructorOptions& options, const Workspace& workspace,
                    const std::vector<ReadablePicture>& pictures, bool matches_all_pairs,
                    const Stage& database, const WorkspaceState& state);

// Remembers how long each kind of work took on this machine, for later runs.
void RememberJob(JobProgress* progress);

}  // namespace colmap_seapoint
