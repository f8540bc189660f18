// Threads that never change a result: every index is computed on its own, and whoever needs an
// order commits afterwards, serially, in the order of the index.
//
// A thread that the system does not give (ulimit -u, ulimit -v, a container's limit) is done
// without: the work runs on those that could be had, at worst on the caller's alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace colmap_seapoint {

// -1 (or 0) = all cores of this machine; never below 1.
int EffectiveNumThreads(int num_threads);

// Calls work(i) for every i in [0, count), in any order, on up to num_threads threads (the caller's
// is one of them). All are called, even when some fail; then the exception of the smallest failing
// index is rethrown. May be nested.
void ParallelFor(int num_threads, int64_t count, const std::function<void(int64_t)>& work);

// OrderedPipeline without the results, which `produce` and `consume` hand over by themselves: index
// i is not produced before i - window is consumed.
void RunOrdered(int num_threads, int64_t count, int64_t window,
                const std::function<void(int64_t)>& produce,
                const std::function<void(int64_t)>& consume);

// produce(i) runs on up to num_threads threads ahead of consume(i, result), which the caller's
// thread runs strictly in order. At most `window` results exist at once, so memory does not grow
// with `count`. An exception of produce(i) is rethrown when its turn to be consumed comes: all
// before it are consumed by then. After an exception nothing more is begun.
template <typename Result>
void OrderedPipeline(int num_threads, int64_t count, int64_t window,
                     const std::function<Result(int64_t)>& produce,
                     const std::function<void(int64_t, Result&&)>& consume) {
  std::vector<std::optional<Result>> results(static_cast<size_t>(window));
  const auto slot = [&](int64_t i) -> std::optional<Result>& {
    return results[static_cast<size_t>(i % window)];
  };
  RunOrdered(
      num_threads, count, window, [&](int64_t i) { slot(i) = produce(i); },
      [&](int64_t i) {
        Result result = std::move(*slot(i));
        slot(i).reset();
        consume(i, std::move(result));
      });
}

}  // namespace colmap_seapoint
