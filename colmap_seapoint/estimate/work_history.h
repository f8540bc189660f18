// How fast this machine was before: a small file of its last runs, which makes the first estimate
// of the next one better. It is a convenience: what cannot be read or written is done without,
// silently.
#pragma once

#include <filesystem>
#include <optional>

#include "colmap_seapoint/estimate/work_costs.h"

namespace colmap_seapoint {

// $XDG_CACHE_HOME/colmap_seapoint/history.json, or ~/.cache/...; nullopt where neither is set.
std::optional<std::filesystem::path> HistoryPath();

// What one run took of each kind of work, as a ratio to what was expected of a machine without
// history; 0 = there was too little of it to tell.
using RunRatios = OfWork<double>;

// For each kind the median of the last runs' ratios, with one of 1 added, so that a single odd run
// does not decide. Never throws.
OfWork<double> ReadMachineRatios(const std::filesystem::path& history);

// Adds a run and drops the oldest above kMaxRuns. Atomic. Never throws.
inline constexpr size_t kMaxRuns = 20;
void AddRun(const std::filesystem::path& history, const RunRatios& ratios);

}  // namespace colmap_seapoint
