// Threads that never change a result: every index is computed on its own, and whoever needs an
// order commits afterwards, serially, in the order of the index.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace colmap_seapoint {

// -1 (or 0) = all cores of this machine; never below 1.
int EffectiveNumThreads(int num_threads);

// Calls work(i) for every i in [0, count), in any order, on up to num_threads threads (the caller's
// is one of them). Rethrows the exception of the smallest failing index.
void ParallelFor(int num_threads, int64_t count, const std::function<void(int64_t)>& work);

// produce(i) runs on num_threads threads ahead of consume(i, result), which the caller's thread
// runs strictly in order. At most `window` results exist at once, so memory does not grow with
// `count`. An exception of produce(i) is rethrown when its turn to be consumed comes.
template <typename Result>
void OrderedPipeline(int num_threads, int64_t count, int64_t window,
                     const std::function<Result(int64_t)>& produce,
                     const std::function<void(int64_t, Result&&)>& consume) {
  struct Slot {
    bool done = false;
    Result result{};
    std::exception_ptr error;
  };
  std::mutex mutex;
  std::condition_variable produced, consumed;
  int64_t next_to_produce = 0, next_to_consume = 0;
  bool stop = false;
  std::vector<Slot> slots(static_cast<size_t>(window));

  auto worker = [&] {
    while (true) {
      int64_t index;
      {
        std::unique_lock<std::mutex> lock(mutex);
        consumed.wait(lock, [&] {
          return stop || next_to_produce >= count || next_to_produce < next_to_consume + window;
        });
        if (stop || next_to_produce >= count) return;
        index = next_to_produce++;
      }
      Slot filled;
      try {
        filled.result = produce(index);
      } catch (...) {
        filled.error = std::current_exception();
      }
      filled.done = true;
      std::lock_guard<std::mutex> lock(mutex);
      slots[static_cast<size_t>(index % window)] = std::move(filled);
      produced.notify_all();
    }
  };

  std::vector<std::thread> threads;
  for (int t = 0; t < num_threads; ++t) threads.emplace_back(worker);
  auto finish = [&] {
    {
      std::lock_guard<std::mutex> lock(mutex);
      stop = true;
    }
    consumed.notify_all();
    for (auto& thread : threads) thread.join();
  };
  try {
    for (int64_t i = 0; i < count; ++i) {
      Slot slot;
      {
        std::unique_lock<std::mutex> lock(mutex);
        Slot& waiting = slots[static_cast<size_t>(i % window)];
        produced.wait(lock, [&] { return waiting.done; });
        slot = std::move(waiting);
        waiting = Slot();
      }
      if (slot.error) std::rethrow_exception(slot.error);
      consume(i, std::move(slot.result));
      {
        std::lock_guard<std::mutex> lock(mutex);
        next_to_consume = i + 1;
      }
      consumed.notify_all();
    }
  } catch (...) {
    finish();
    throw;
  }
  finish();
}

}  // namespace colmap_seapoint
