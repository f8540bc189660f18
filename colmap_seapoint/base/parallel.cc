#include "colmap_seapoint/base/parallel.h"

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <fstream>
#include <limits>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>

#include "colmap_seapoint/base/hold/work_pause.h"

namespace colmap_seapoint {
namespace {

// A thread's stack takes from the address space that `ulimit -v` leaves (8 MB each, touched or
// not): threads may have a quarter of it, the work needs the rest.
int64_t ThreadsThatFit() {
  constexpr uint64_t kNoLimit = std::numeric_limits<int64_t>::max();
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kNoLimit;
  uint64_t pages = 0;
  if (!(std::ifstream("/proc/self/statm") >> pages)) return kNoLimit;
  const uint64_t used = pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  size_t stack_bytes = 0;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_getstacksize(&attributes, &stack_bytes);
  pthread_attr_destroy(&attributes);
  const uint64_t room = limit.rlim_cur > used ? limit.rlim_cur - used : 0;
  return static_cast<int64_t>(room / 4 / std::max<size_t>(stack_bytes, 1));
}

// Up to `count` threads that run `work`, joined at the end of the scope. oneTBB instead would end
// the program where its workers cannot be started (2021.8, as Debian 12 has it).
class ThreadTeam {
 public:
  ThreadTeam(int64_t count, const std::function<void()>& work) {
    count = std::min(count, ThreadsThatFit());
    try {
      for (int64_t t = 0; t < count; ++t) threads_.emplace_back(work);
    } catch (const std::system_error&) {  // those that run are enough
    } catch (const std::bad_alloc&) {
    }
  }
  ~ThreadTeam() {
    for (std::thread& thread : threads_) thread.join();
  }
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  bool IsEmpty() const { return threads_.empty(); }

 private:
  std::vector<std::thread> threads_;
};

// What producing threads and the consuming one know of each other.
class Order {
 public:
  Order(int64_t count, int64_t window, const std::function<void(int64_t)>& produce)
      : count_(count), window_(window), produce_(produce), made_(static_cast<size_t>(window)) {}

  // A producing thread's life.
  void Produce() {
    while (const auto index = Next()) {
      Made made;
      made.is_done = true;
      try {
        WaitWhilePaused();
        produce_(*index);
      } catch (...) {
        made.error = std::current_exception();
      }
      const std::lock_guard<std::mutex> lock(mutex_);
      made_[static_cast<size_t>(*index % window_)] = made;
      produced_.notify_all();
    }
  }

  // Waits until `index` is produced; throws what produce threw.
  void Take(int64_t index) {
    std::unique_lock<std::mutex> lock(mutex_);
    Made& made = made_[static_cast<size_t>(index % window_)];
    produced_.wait(lock, [&] { return made.is_done; });
    const std::exception_ptr error = std::exchange(made, Made()).error;
    if (error) std::rethrow_exception(error);
  }

  void SetConsumed(int64_t index) {
    const std::lock_guard<std::mutex> lock(mutex_);
    next_to_consume_ = index + 1;
    consumed_.notify_all();
  }

  void Stop() {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_stopped_ = true;
    consumed_.notify_all();
  }

 private:
  struct Made {
    bool is_done = false;
    std::exception_ptr error;
  };

  // Waits for room in the window; nullopt when there is nothing more to produce.
  std::optional<int64_t> Next() {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto is_over = [&] { return is_stopped_ || next_to_produce_ >= count_; };
    consumed_.wait(lock,
                   [&] { return is_over() || next_to_produce_ < next_to_consume_ + window_; });
    if (is_over()) return std::nullopt;
    return next_to_produce_++;
  }

  const int64_t count_, window_;
  const std::function<void(int64_t)>& produce_;
  std::mutex mutex_;
  std::condition_variable produced_, consumed_;
  std::vector<Made> made_;  // by index modulo window
  int64_t next_to_produce_ = 0, next_to_consume_ = 0;
  bool is_stopped_ = false;
};

// Ends the threads that wait for room, before the team is joined.
class StopAtEnd {
 public:
  explicit StopAtEnd(Order* order) : order_(order) {}
  ~StopAtEnd() { order_->Stop(); }

 private:
  Order* order_;
};

}  // namespace

int EffectiveNumThreads(int num_threads) {
  if (num_threads > 0) return num_threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void ParallelFor(int num_threads, int64_t count, const std::function<void(int64_t)>& work) {
  std::atomic<int64_t> next{0};
  std::mutex mutex;
  int64_t failed_index = count;
  std::exception_ptr error;
  const auto run = [&] {
    for (int64_t i = next++; i < count; i = next++) {
      try {
        WaitWhilePaused();
        work(i);
      } catch (const WorkStopped&) {  // whatever the others have to say
        next = count;
        const std::lock_guard<std::mutex> lock(mutex);
        failed_index = -1;
        error = std::current_exception();
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (i >= failed_index) continue;
        failed_index = i;
        error = std::current_exception();
      }
    }
  };
  {
    const int64_t num_helpers = std::min<int64_t>(EffectiveNumThreads(num_threads), count) - 1;
    const ThreadTeam team(num_helpers, run);
    run();
  }
  if (error) std::rethrow_exception(error);
}

void RunOrdered(int num_threads, int64_t count, int64_t window,
                const std::function<void(int64_t)>& produce,
                const std::function<void(int64_t)>& consume) {
  Order order(count, window, produce);
  const ThreadTeam team(std::min<int64_t>(EffectiveNumThreads(num_threads), count),
                        [&] { order.Produce(); });
  const StopAtEnd stop(&order);
  for (int64_t i = 0; i < count; ++i) {
    if (team.IsEmpty()) {
      WaitWhilePaused();
      produce(i);
    } else {
      order.Take(i);
    }
    consume(i);
    order.SetConsumed(i);
  }
}

}  // namespace colmap_seapoint
