#include "colmap_seapoint/base/hold/work_pause.h"

#include <atomic>
#include <condition_variable>
#include <mutex>

#include "colmap_seapoint/base/hold/work_clock.h"

namespace colmap_seapoint {
namespace {

std::atomic<bool> work_is_held{false};
std::mutex hold_mutex;  // guards the two below
unsigned pause_reasons = 0;
std::string stopped_why;
std::condition_variable hold_changed;

// Callers hold hold_mutex.
void TellOfChange() {
  work_is_held = pause_reasons != 0 || !stopped_why.empty();
  SetWorkClockPaused(pause_reasons != 0);
  hold_changed.notify_all();
}

}  // namespace

void SetWorkPaused(PauseReason reason, bool is_paused) {
  const std::lock_guard<std::mutex> lock(hold_mutex);
  const auto bit = static_cast<unsigned>(reason);
  pause_reasons = is_paused ? pause_reasons | bit : pause_reasons & ~bit;
  TellOfChange();
}

bool IsWorkHeld() { return work_is_held.load(std::memory_order_relaxed); }

void WaitWhilePaused() {
  if (!IsWorkHeld()) return;
  std::unique_lock<std::mutex> lock(hold_mutex);
  hold_changed.wait(lock, [] { return pause_reasons == 0 || !stopped_why.empty(); });
  if (!stopped_why.empty()) throw WorkStopped(stopped_why);
}

void StopWork(const std::string& why) {
  const std::lock_guard<std::mutex> lock(hold_mutex);
  stopped_why = why;
  TellOfChange();
}

}  // namespace colmap_seapoint
