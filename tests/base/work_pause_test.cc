#include "colmap_seapoint/base/hold/work_pause.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "colmap_seapoint/base/parallel.h"

namespace colmap_seapoint {
namespace {

using std::chrono::milliseconds;

class WorkPauseTest : public testing::Test {
 protected:
  ~WorkPauseTest() override {
    SetWorkPaused(PauseReason::kBattery, false);
    SetWorkPaused(PauseReason::kDisk, false);
    StopWork("");
  }

  // Why it was stopped; "" when it came to its end.
  template <typename Function>
  static std::string StoppedWhy(const Function& function) {
    try {
      function();
    } catch (const WorkStopped& stopped) {
      return stopped.what();
    }
    return "";
  }
};

TEST_F(WorkPauseTest, LastsAsLongAsOneReason) {
  SetWorkPaused(PauseReason::kBattery, true);
  SetWorkPaused(PauseReason::kDisk, true);
  SetWorkPaused(PauseReason::kBattery, false);
  EXPECT_TRUE(IsWorkHeld());
  std::atomic<bool> goes_on{false};
  std::thread waiting([&] {
    WaitWhilePaused();
    goes_on = true;
  });
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_FALSE(goes_on);
  SetWorkPaused(PauseReason::kDisk, false);
  waiting.join();
  EXPECT_TRUE(goes_on);
  EXPECT_FALSE(IsWorkHeld());
}

TEST_F(WorkPauseTest, StoppedWorkEndsSoon) {
  for (const int num_threads : {1, 2, 8}) {
    std::atomic<int> count{0};
    const auto one = [&](int64_t) {
      if (++count == 20) StopWork("no room");
    };
    EXPECT_EQ(StoppedWhy([&] { ParallelFor(num_threads, 1'000'000'000, one); }), "no room");
    EXPECT_LT(count, 20 + num_threads);
    EXPECT_EQ(StoppedWhy([&] { ParallelFor(num_threads, 1, one); }), "no room");
    StopWork("");
    count = 0;
    EXPECT_EQ(StoppedWhy([&] { RunOrdered(num_threads, 1'000'000'000, 4, one, [](int64_t) {}); }),
              "no room");
    EXPECT_LT(count, 20 + num_threads);
    StopWork("");
    EXPECT_EQ(StoppedWhy([&] { ParallelFor(num_threads, 10, [](int64_t) {}); }), "");
  }
}

// Nobody puts the machine on mains for work that is over.
TEST_F(WorkPauseTest, AStopEndsAPause) {
  SetWorkPaused(PauseReason::kBattery, true);
  std::thread stopping([] {
    std::this_thread::sleep_for(milliseconds(20));
    StopWork("no room");
  });
  EXPECT_EQ(StoppedWhy(WaitWhilePaused), "no room");
  stopping.join();
}

}  // namespace
}  // namespace colmap_seapoint
