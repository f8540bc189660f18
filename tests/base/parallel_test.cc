#include "colmap_seapoint/base/parallel.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>

namespace colmap_seapoint {
namespace {

constexpr int kThreadCounts[] = {1, 2, 3, 8, 64};

void Pause() { std::this_thread::sleep_for(std::chrono::microseconds(200)); }

// What it threw; "" for nothing.
template <typename Function>
std::string Thrown(const Function& function) {
  try {
    function();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

// Leaves room in the address space for a few threads only. For children: it cannot be undone.
void LimitAddressSpace(uint64_t free_bytes) {
  uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const uint64_t bytes = pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) + free_bytes;
  const rlimit limit = {bytes, bytes};
  setrlimit(RLIMIT_AS, &limit);
}

TEST(EffectiveNumThreads, AllCoresOrAsMany) {
  EXPECT_EQ(EffectiveNumThreads(7), 7);
  EXPECT_EQ(EffectiveNumThreads(1), 1);
  EXPECT_GE(EffectiveNumThreads(-1), 1);
  EXPECT_EQ(EffectiveNumThreads(0), EffectiveNumThreads(-1));
}

TEST(ParallelFor, EveryIndexOnce) {
  for (const int num_threads : kThreadCounts) {
    for (const int64_t count : {0, 1, 2, 100}) {
      std::vector<std::atomic<int>> calls(static_cast<size_t>(count));
      ParallelFor(num_threads, count, [&](int64_t i) { ++calls[static_cast<size_t>(i)]; });
      for (const auto& number : calls) EXPECT_EQ(number, 1);
    }
  }
}

TEST(ParallelFor, AsManyThreadsAsAskedFor) {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  const auto note = [&](int64_t) {
    Pause();
    const std::lock_guard<std::mutex> lock(mutex);
    threads.insert(std::this_thread::get_id());
  };
  ParallelFor(3, 200, note);
  EXPECT_LE(threads.size(), 3u);
  EXPECT_GE(threads.size(), 2u);
  threads.clear();
  ParallelFor(1, 20, note);
  EXPECT_EQ(threads, std::set<std::thread::id>{std::this_thread::get_id()});
}

TEST(ParallelFor, TheSmallestFailingIndexIsTheError) {
  for (const int num_threads : kThreadCounts) {
    std::atomic<int> num_calls{0};
    const auto work = [&](int64_t i) {
      ++num_calls;
      if (i % 10 == 7) throw std::runtime_error(std::to_string(i));
    };
    EXPECT_EQ(Thrown([&] { ParallelFor(num_threads, 100, work); }), "7");
    EXPECT_EQ(num_calls, 100);
  }
}

TEST(ParallelFor, Nested) {
  std::atomic<int64_t> sum{0};
  ParallelFor(4, 8, [&](int64_t i) { ParallelFor(4, 10, [&](int64_t k) { sum += 10 * i + k; }); });
  EXPECT_EQ(sum, 79 * 80 / 2);
}

TEST(OrderedPipeline, ConsumesInOrderOnTheCallersThread) {
  const auto caller = std::this_thread::get_id();
  for (const int num_threads : kThreadCounts) {
    std::vector<int64_t> consumed;
    OrderedPipeline<std::unique_ptr<int64_t>>(
        num_threads, 50, 2 * num_threads,
        [](int64_t i) {
          if (i % 3 == 0) Pause();  // later ones are ready first
          return std::make_unique<int64_t>(i * i);
        },
        [&](int64_t i, std::unique_ptr<int64_t>&& result) {
          EXPECT_EQ(std::this_thread::get_id(), caller);
          EXPECT_EQ(*result, i * i);
          consumed.push_back(i);
        });
    std::vector<int64_t> expected(50);
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_EQ(consumed, expected);
  }
}

TEST(OrderedPipeline, NeverMoreResultsThanTheWindow) {
  for (const int64_t window : {1, 3, 8}) {
    std::atomic<int64_t> num_consumed{0}, most_ahead{0};
    OrderedPipeline<int>(
        8, 60, window,
        [&](int64_t i) {
          const int64_t ahead = i - num_consumed + 1;
          int64_t most = most_ahead;
          while (ahead > most && !most_ahead.compare_exchange_weak(most, ahead)) {
          }
          return 0;
        },
        [&](int64_t, int&&) {
          Pause();
          ++num_consumed;
        });
    EXPECT_LE(most_ahead, window);
    EXPECT_GE(most_ahead, std::min<int64_t>(window, 2));
  }
}

TEST(OrderedPipeline, NothingToDo) {
  OrderedPipeline<int>(
      4, 0, 8, [](int64_t) -> int { throw std::runtime_error("produced"); },
      [](int64_t, int&&) { throw std::runtime_error("consumed"); });
}

TEST(OrderedPipeline, AFailureComesInItsTurn) {
  for (const int num_threads : kThreadCounts) {
    int64_t num_consumed = 0;
    const auto run = [&] {
      OrderedPipeline<int>(
          num_threads, 40, 16,
          [](int64_t i) {
            if (i >= 20) throw std::runtime_error(std::to_string(i));
            Pause();
            return 0;
          },
          [&](int64_t, int&&) { ++num_consumed; });
    };
    EXPECT_EQ(Thrown(run), "20");
    EXPECT_EQ(num_consumed, 20);
  }
}

TEST(OrderedPipeline, AFailingConsumerEndsIt) {
  std::atomic<int> num_produced{0};
  const auto run = [&] {
    OrderedPipeline<int>(
        4, 1000, 8, [&](int64_t) { return ++num_produced; },
        [](int64_t i, int&&) {
          if (i == 5) throw std::runtime_error("full");
        });
  };
  EXPECT_EQ(Thrown(run), "full");
  EXPECT_LE(num_produced, 5 + 8);
}

TEST(OrderedPipeline, NestedWithParallelFor) {
  int64_t sum = 0;
  OrderedPipeline<int64_t>(
      3, 10, 6,
      [](int64_t i) {
        std::atomic<int64_t> part{0};
        ParallelFor(3, 10, [&](int64_t k) { part += 10 * i + k; });
        return part.load();
      },
      [&](int64_t, int64_t&& part) { sum += part; });
  EXPECT_EQ(sum, 99 * 100 / 2);
}

// No thread beside the first one. Root has no such limit, so that it becomes nobody.
void LimitProcesses() {
  constexpr uid_t kNobody = 65534;
  const rlimit limit = {1, 1};
  setrlimit(RLIMIT_NPROC, &limit);
  if (geteuid() == 0 && setuid(kNobody) != 0) _exit(2);
  try {
    std::thread([] {}).join();
    _exit(3);
  } catch (const std::system_error&) {
  }
}

// Exits with 42 when all is as with as many threads as are asked for.
[[noreturn]] void WorkWithManyThreads() {
  std::atomic<int64_t> sum{0};
  ParallelFor(1000, 2000, [&](int64_t i) {
    Pause();
    sum += i;
  });
  int64_t ordered = 0;
  OrderedPipeline<int64_t>(
      1000, 2000, 2000,
      [](int64_t i) {
        Pause();
        return i;
      },
      [&](int64_t i, int64_t&& result) { ordered += i == result ? i : 0; });
  const int64_t expected = 1999 * 2000 / 2;
  _exit(sum == expected && ordered == expected ? 42 : 1);
}

// 8 MB a stack: 1000 threads are more than these children get.
TEST(ThreadsThatCannotBeStarted, AreDoneWithout) {
  EXPECT_EXIT((LimitAddressSpace(400 << 20), WorkWithManyThreads()), testing::ExitedWithCode(42),
              "");
  EXPECT_EXIT((LimitAddressSpace(4 << 20), WorkWithManyThreads()), testing::ExitedWithCode(42), "");
  EXPECT_EXIT((LimitProcesses(), WorkWithManyThreads()), testing::ExitedWithCode(42), "");
}

}  // namespace
}  // namespace colmap_seapoint
