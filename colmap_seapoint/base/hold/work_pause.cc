#include "colmap_seapoint/base/hold/work_pause.h"

#include <atomic>
#include <condition_variable>
#include <mutex>

namespace colmap_seapoint {
namespace {

std::atomic<bool> work_is_paused{false};
std::mutex pause_mutex;
std::condition_variable pause_ended;

}  // namespace

void SetWorkPaused(bool is_paused) {
  const std::lock_guard<std::mutex> lock(pause_mutex);
  work_is_paused = is_paused;
  pause_ended.notify_all();
}

bool IsWorkPaused() { return work_is_paused.load(std::memory_order_relaxed); }

void WaitWhilePaused() {
  if (!IsWorkPaused()) return;
  std::unique_lock<std::mutex> lock(pause_mutex);
  pause_ended.wait(lock, [] { return !work_is_paused; });
}

}  // namespace colmap_seapoint
