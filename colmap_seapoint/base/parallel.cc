#include "colmap_seapoint/base/parallel.h"

#include <algorithm>
#include <atomic>

namespace colmap_seapoint {

int EffectiveNumThreads(int num_threads) {
  if (num_threads > 0) return num_threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void ParallelFor(int num_threads, int64_t count, const std::function<void(int64_t)>& work) {
  num_threads = static_cast<int>(std::min<int64_t>(EffectiveNumThreads(num_threads), count));
  if (num_threads <= 1) {
    for (int64_t i = 0; i < count; ++i) work(i);
    return;
  }
  std::atomic<int64_t> next{0};
  std::mutex mutex;
  int64_t failed_index = count;
  std::exception_ptr error;
  auto run = [&] {
    for (int64_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        std::lock_guard<std::mutex> lock(mutex);
        if (i < failed_index) {
          failed_index = i;
          error = std::current_exception();
        }
      }
    }
  };
  std::vector<std::thread> threads;
  for (int t = 1; t < num_threads; ++t) threads.emplace_back(run);
  run();
  for (auto& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace colmap_seapoint
