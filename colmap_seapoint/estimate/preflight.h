// What a job says before it begins: how large it is, whether the machine can hold it, how long it
// will take; and the plan that its progress goes by from there on.
#pragma once

#include <filesystem>

#include "colmap_seapoint/estimate/job_progress.h"

namespace colmap_seapoint {

// The costs on this machine, by its history.
OfWork<WorkCost> CostsHere(const JobSize& size);

// Where the disk of `workspace` is too small by far: an Error if `check_disk`, else a warning, as
// where it may be too small.
void PlanJob(const JobSize& size, const std::filesystem::path& workspace, bool check_disk,
             const OfWork<bool>& done_before, JobProgress* progress);

// Remembers how long each kind of work took on this machine, for later runs.
void RememberJob(JobProgress* progress);

}  // namespace colmap_seapoint
