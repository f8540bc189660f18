#include "colmap_seapoint/system/memory_budget.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>

#include "colmap_seapoint/system/memory_limit.h"

namespace colmap_seapoint {
namespace {

std::mutex budget_mutex;
std::condition_variable share_returned;
uint64_t max_memory = 0;  // 0: not asked for yet
uint64_t num_taken = 0;   // bytes
thread_local bool thread_has_share = false;

// Callers hold budget_mutex.
uint64_t Budget() {
  if (max_memory == 0) max_memory = AvailableMemoryBytes() / 4 * 3;
  return max_memory;
}

}  // namespace

void SetMaxMemory(uint64_t bytes) {
  const std::lock_guard<std::mutex> lock(budget_mutex);
  max_memory = bytes;
}

uint64_t MaxMemory() {
  const std::lock_guard<std::mutex> lock(budget_mutex);
  return Budget();
}

MemoryShare::MemoryShare(uint64_t bytes) : bytes_(0) {
  if (thread_has_share || bytes == 0) return;
  std::unique_lock<std::mutex> lock(budget_mutex);
  bytes_ = std::min(bytes, Budget());
  share_returned.wait(lock, [&] { return num_taken == 0 || num_taken + bytes_ <= Budget(); });
  num_taken += bytes_;
  thread_has_share = true;
}

MemoryShare::~MemoryShare() {
  if (bytes_ == 0) return;
  {
    const std::lock_guard<std::mutex> lock(budget_mutex);
    num_taken -= bytes_;
  }
  thread_has_share = false;
  share_returned.notify_all();
}

}  // namespace colmap_seapoint
