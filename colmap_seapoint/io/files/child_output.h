// What a child prints, while it prints it: into a log, line by line to who asked, and never more of
// it in memory or on the disk than a bound. For subprocess.cc only.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace colmap_seapoint {

struct ChildOutputOptions {
  std::filesystem::path program;   // errors and words about silence name it
  std::filesystem::path log_path;  // truncated first; empty = nowhere
  std::function<void(const std::string&)> on_line;
  double timeout_seconds = 0;  // since the start, pauses apart; 0 = none
  // Stops the child for a pause of all work (base/hold/work_pause.h), and lets it go on.
  std::function<void(bool)> stop = [](bool) {};
  // Silent for so long, a line says so; then again after twice as long, and so on.
  double silence_seconds = 60;
};

class ChildOutput {
 public:
  static constexpr size_t kMaxLineBytes = 1 << 12;  // on_line gets the beginning
  static constexpr uint64_t kMaxLogBytes = 1 << 26;

  // Throws Error when the log cannot be created.
  explicit ChildOutput(const ChildOutputOptions& options);
  ~ChildOutput();
  ChildOutput(const ChildOutput&) = delete;
  ChildOutput& operator=(const ChildOutput&) = delete;

  // Reads from this pipe until its other end is closed by all. Throws Error when the log cannot be
  // written or the time is over, and whatever on_line throws.
  void CopyFrom(int pipe);

 private:
  void WaitFor(int pipe);
  void PauseIfAsked();
  void Log(const char* data, size_t size);
  void WriteLog(const char* data, size_t size);
  void Split(const char* data, size_t size);

  const ChildOutputOptions options_;
  int log_ = -1;
  uint64_t log_bytes_ = 0;
  std::string line_;
  const double start_seconds_;  // by the work's clock (base/hold/work_clock.h)
  double last_output_seconds_;
  double next_silence_seconds_;
};

}  // namespace colmap_seapoint
