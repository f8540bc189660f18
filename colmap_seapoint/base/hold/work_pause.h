// A pause of all work, as for a battery that runs low, and its end before the work is done: while a
// pause lasts, ParallelFor and RunOrdered (base/parallel.h) begin no further index, and a child
// that runs for us is stopped. From any thread. A pause never changes a result.
#pragma once

#include <stdexcept>
#include <string>

namespace colmap_seapoint {

// Who asks for a pause; work goes on when none of them does.
enum class PauseReason : unsigned { kBattery = 1, kDisk = 2 };

void SetWorkPaused(PauseReason reason, bool is_paused);
// Whether WaitWhilePaused() would not return at once.
bool IsWorkHeld();
// Throws WorkStopped when the work is to end.
void WaitWhilePaused();

// Not an Error, which a stage may take for a fault of one picture or one model, and go on.
class WorkStopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;  // as Error's: where, finding, remedy
};

// All work ends at the next index, paused or not, with WorkStopped of this text; "" takes that
// back.
void StopWork(const std::string& why);

}  // namespace colmap_seapoint
