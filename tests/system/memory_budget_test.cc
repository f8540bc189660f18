#include "colmap_seapoint/system/memory_budget.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "colmap_seapoint/system/memory_limit.h"

namespace colmap_seapoint {
namespace {

// The largest sum of shares that were held at the same time by 8 threads of 50 shares each.
uint64_t MostAtOnce(uint64_t budget, uint64_t share_bytes) {
  SetMaxMemory(budget);
  std::atomic<uint64_t> held{0}, most{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        const MemoryShare share(share_bytes);
        const uint64_t now = held += share_bytes;
        uint64_t before = most;
        while (now > before && !most.compare_exchange_weak(before, now)) {
        }
        std::this_thread::sleep_for(std::chrono::microseconds(200));
        held -= share_bytes;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  return most;
}

TEST(MemoryShare, NeverMoreThanTheBudget) {
  EXPECT_LE(MostAtOnce(1000, 300), 900u);
  EXPECT_GE(MostAtOnce(1000, 300), 600u);  // but as many as fit
}

TEST(MemoryShare, WhatIsLargerThanTheBudgetIsAlone) { EXPECT_EQ(MostAtOnce(1000, 5000), 5000u); }

TEST(MemoryShare, AThreadNeverWaitsForItself) {
  SetMaxMemory(1000);
  const MemoryShare outer(900);
  const MemoryShare inner(900);
  SetMaxMemory(2000);
  EXPECT_EQ(MaxMemory(), 2000u);
}

TEST(MemoryShare, EndsWithTheScopeAfterANestedOne) {
  SetMaxMemory(1000);
  {
    const MemoryShare outer(900);
    { const MemoryShare inner(900); }
  }
  std::thread([] { const MemoryShare share(1000); }).join();
}

}  // namespace
}  // namespace colmap_seapoint
