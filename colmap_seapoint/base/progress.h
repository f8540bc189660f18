// What a person sees while a command runs: log lines and progress with the time left, on stderr.
// feature/ and densify/ do not use it: they never print.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

#include "colmap_seapoint/base/work.h"

namespace colmap_seapoint {

enum class LogLevel : int { kError = 0, kWarning = 1, kInfo = 2, kDebug = 3 };

// Lines above this level are not printed. Progress counts as kInfo.
void SetLogLevel(LogLevel level);
LogLevel GetLogLevel();

// One line each, from any thread, control characters in it made visible ("\n", "\x1b"); a rewriting
// progress line is wiped first and comes back later.
void LogError(const std::string& line);
void LogWarning(const std::string& line);
void LogInfo(const std::string& line);
void LogDebug(const std::string& line);

// "42 s", "3 min 05 s", "2 h 07 min".
std::string DurationText(double seconds);

// One counted part of the work. On a terminal a single line is rewritten; elsewhere a plain line
// appears when it tells something new: at least 10 s after the last one, and 10 % further. Where
// the whole job is observed (work.h), the line is the observer's. While a Heartbeat lives
// (below), a line also appears where nothing is counted for long.
class Progress {
 public:
  // `already_done` of `total` were finished by an earlier run: they do not count for the speed.
  Progress(const std::string& label, int64_t total, int64_t already_done = 0,
           Work work = Work::kOther);
  ~Progress();  // wipes an unfinished rewriting line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Update(int64_t done);
  void Finish();  // "<label>: <total> in <time>"
  // What it says now, from any thread: how much is done, and the time left.
  std::string Line() const;

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_;
  int64_t total_ = 0;
  int64_t already_done_ = 0;
  Work work_;
  bool finished_ = false;
  double start_seconds_;  // by the work's clock
  Clock::time_point last_line_;
  int64_t last_done_ = 0;
  std::atomic<int64_t> done_;
};

inline constexpr double kMaxSilenceSeconds = 20;

// No silence: while it lives, a line says at least every kMaxSilenceSeconds how far the work is,
// also where the work itself has nothing to count (a search in COLMAP, a matrix that is solved). On
// a terminal the rewriting line is kept up to date.
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
