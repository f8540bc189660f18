// No silence: while it lives, a line says at least every kMaxSilenceSeconds how far the work is,
// also where the work itself has nothing to count (a search in COLMAP, a matrix that is solved). On
// a terminal the rewriting line is kept up to date.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

namespace colmap_seapoint {

inline constexpr double kMaxSilenceSeconds = 20;

class Heartbeat {
 public:
  // A thread that the system does not give is done without.
  Heartbeat();
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace colmap_seapoint
