// What a job says before it begins: how large it is, whether the machine can hold it, how long it
// will take; and the plan that its progress goes by from there on.
#pragma once

#include <filesystem>

#include "colmap_seapoint/estimate/job_progress.h"

namespace colmap_seapoint {

// The costs on this machine, by its history.
OfWork<WorkCost> CostsHere(const JobSize& size);

// Whether the disk of `workspace` is large enough is judged elsewhere (disk/job_disk.h).
void PlanJob(const JobSize& size, const std::filesystem::path& workspace,
             const OfWork<bool>& done_before, JobProgress* progress);

// Remembers how long each kind of work took on this machine, for later runs.
void RememberJob(JobProgress* progress);

}  // namespace colmap_seapoint
