// CPU and wall time of one piece of work.
#pragma once

#include <chrono>
#include <thread>

#include "colmap_seapoint/base/timer.h"

namespace colmap_seapoint {

struct WorkSeconds {
  double cpu = 0, wall = 0;
};

// CPU: user + sys of the whole process. OpenCV's idle threads spin for a moment before they sleep,
// which must not be counted to whoever comes next.
template <typename Work>
WorkSeconds SecondsOf(const Work& work) {
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const Timer timer;
  work();
  return {timer.CpuSeconds(), timer.WallSeconds()};
}

template <typename Work>
double CpuSecondsOf(const Work& work) {
  return SecondsOf(work).cpu;
}

}  // namespace colmap_seapoint
