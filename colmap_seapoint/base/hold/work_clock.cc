#include "colmap_seapoint/base/hold/work_clock.h"

#include <chrono>
#include <mutex>

namespace colmap_seapoint {
namespace {

// Of Linux it does not count the machine's sleep.
using Clock = std::chrono::steady_clock;

std::mutex clock_mutex;  // guards all below
Clock::time_point last_look = Clock::now();
double worked_seconds = 0;
bool is_paused_now = false;
bool is_beating = false;

// Callers hold clock_mutex.
void Look() {
  const Clock::time_point now = Clock::now();
  const double passed = std::chrono::duration<double>(now - last_look).count();
  last_look = now;
  const bool stood_still = is_beating && passed > kStandstillSeconds;
  if (!is_paused_now && !stood_still) worked_seconds += passed;
}

}  // namespace

double WorkSeconds() {
  const std::lock_guard<std::mutex> lock(clock_mutex);
  Look();
  return worked_seconds;
}

void TellWorkClock(Beat beat) {
  const std::lock_guard<std::mutex> lock(clock_mutex);
  Look();
  is_beating = beat == Beat::kNow;
}

void SetWorkClockPaused(bool is_paused) {
  const std::lock_guard<std::mutex> lock(clock_mutex);
  Look();
  is_paused_now = is_paused;
}

}  // namespace colmap_seapoint
