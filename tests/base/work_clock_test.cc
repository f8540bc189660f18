#include "colmap_seapoint/base/hold/work_clock.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "colmap_seapoint/base/hold/work_pause.h"
#include "colmap_seapoint/base/progress.h"

namespace colmap_seapoint {
namespace {

void SleepMs(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

TEST(WorkClock, Goes) {
  const double before = WorkSeconds();
  SleepMs(60);
  EXPECT_GE(WorkSeconds() - before, 0.06);
}

TEST(WorkClock, APauseDoesNotCount) {
  const double before = WorkSeconds();
  SetWorkPaused(PauseReason::kDisk, true);
  SetWorkPaused(PauseReason::kBattery, true);
  SleepMs(2000);
  SetWorkPaused(PauseReason::kDisk, false);
  SleepMs(1000);
  SetWorkPaused(PauseReason::kBattery, false);
  SleepMs(60);
  EXPECT_GE(WorkSeconds() - before, 0.06);
  EXPECT_LT(WorkSeconds() - before, 2);
}

// Seconds of work by a process that works for two seconds and is stopped for as long as it takes to
// be noticed.
double WorkOfStoppedProcess() {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    double seconds = 0;
    {
      const Heartbeat heartbeat;
      SleepMs(1000);
      const double before = WorkSeconds();
      kill(getpid(), SIGSTOP);
      SleepMs(1000);
      seconds = WorkSeconds() - before;
    }
    const bool is_told = write(ends[1], &seconds, sizeof(seconds)) == sizeof(seconds);
    _exit(is_told ? 0 : 1);
  }
  waitpid(child, nullptr, WUNTRACED);
  SleepMs(7000);
  kill(child, SIGCONT);
  waitpid(child, nullptr, 0);
  double seconds = -1;
  EXPECT_EQ(read(ends[0], &seconds, sizeof(seconds)), static_cast<ssize_t>(sizeof(seconds)));
  close(ends[0]);
  close(ends[1]);
  return seconds;
}

TEST(WorkClock, AStoppedProcessDoesNotWork) {
  const double seconds = WorkOfStoppedProcess();
  EXPECT_GE(seconds, 0.5);
  EXPECT_LT(seconds, 6);
}

// Nobody beats: a long silence is work.
TEST(WorkClock, WithoutBeatsAllCounts) {
  TellWorkClock(Beat::kNow);
  TellWorkClock(Beat::kBeatsEnd);
  const double before = WorkSeconds();
  SleepMs(5100);
  EXPECT_GE(WorkSeconds() - before, 5.1);
}

}  // namespace
}  // namespace colmap_seapoint
