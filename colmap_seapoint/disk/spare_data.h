// What a workspace holds that is ours, is no result, and can be made again.
#pragma once

#include <vector>

#include "colmap_seapoint/disk/disk_watch.h"
#include "colmap_seapoint/workspace/workspace.h"

namespace colmap_seapoint {

// The parts of a job, in their order.
enum class JobPart : int { kDatabase, kModels, kClouds, kMaps, kReport };

// In the order in which it is given up, and only what this part of the job does not work in:
//   1. what an interrupted run left half made (database.db.tmp, sparse.tmp): nothing is lost;
//   2. of a survey that was watched its coarse database, models and clouds, in watch/: its map and
//      page stay; another watch begins it anew;
//   3. what was measured in the pictures, in state/: the next report reads them all again;
//   4. the maps' memory, in state/: a map whose survey grows is drawn from scratch.
// What a folder of these holds that is not ours stays. Never among them: originals, what they were
// decoded into, results.
std::vector<SpareData> SpareDataOf(const Workspace& workspace, JobPart part);

}  // namespace colmap_seapoint
