#include "colmap_seapoint/base/heartbeat.h"

#include <signal.h>

#include <chrono>
#include <functional>
#include <system_error>

#include "colmap_seapoint/base/progress.h"

namespace colmap_seapoint {
namespace {

constexpr std::chrono::milliseconds kBeat{500};

// Signals are for the threads that work: a child's end, say, is waited for there.
std::thread StartWithoutSignals(const std::function<void()>& run) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread;
  try {
    thread = std::thread(run);
  } catch (const std::system_error&) {
    // Silence is no reason to fail.
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

}  // namespace

Heartbeat::Heartbeat() {
  thread_ = StartWithoutSignals([this] {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ended_.wait_for(lock, kBeat, [this] { return is_over_; })) ShowIfSilent();
  });
}

Heartbeat::~Heartbeat() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    is_over_ = true;
  }
  ended_.notify_all();
  if (thread_.joinable()) thread_.join();
}

}  // namespace colmap_seapoint
