// A pause of all work, as for a battery that runs low: while it lasts, ParallelFor and RunOrdered
// (base/parallel.h) begin no further index, and a child that runs for us is stopped. From any
// thread. It never changes a result.
#pragma once

namespace colmap_seapoint {

void SetWorkPaused(bool is_paused);
bool IsWorkPaused();
void WaitWhilePaused();

}  // namespace colmap_seapoint
