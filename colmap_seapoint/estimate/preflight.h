// What a job says before it begins: how large it is, whether the machine can hold it, how long it
// will take; and the estimate that goes with it from there on.
#pragma once

#include <filesystem>

#include "colmap_seapoint/estimate/job_progress.h"

namespace colmap_seapoint {

// Where the disk of `workspace` is too small by far: an Error if `check_disk`, else a warning, as
// where it may be too small.
JobEstimate PlanJob(const JobSize& size, const std::filesystem::path& workspace, bool check_disk,
                    const OfWork<bool>& done_before);

// Remembers how long each kind of work took on this machine, for later runs.
void RememberJob(JobProgress* progress);

}  // namespace colmap_seapoint
