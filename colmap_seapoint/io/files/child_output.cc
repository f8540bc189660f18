#include "colmap_seapoint/io/files/child_output.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <vector>

#include "colmap_seapoint/base/hold/work_clock.h"
#include "colmap_seapoint/base/hold/work_pause.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kReadBytes = 1 << 16;
constexpr char kLogIsFull[] = "\n[the log is full: what followed is not kept]\n";

}  // namespace

ChildOutput::ChildOutput(const ChildOutputOptions& options)
    : options_(options),
      start_seconds_(WorkSeconds()),
      last_output_seconds_(start_seconds_),
      next_silence_seconds_(options.silence_seconds) {
  if (options_.log_path.empty()) return;
  // Anew, so that a link of that name is replaced and what it leads to is not written over.
  std::error_code ignored;
  const auto type = std::filesystem::symlink_status(options_.log_path, ignored).type();
  const bool is_new = type != std::filesystem::file_type::character;
  if (is_new) unlink(options_.log_path.c_str());
  log_ =
      open(options_.log_path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | (is_new ? O_EXCL : 0), 0666);
  if (log_ < 0) throw SystemError(options_.log_path, "cannot be created", errno);
}

ChildOutput::~ChildOutput() {
  if (log_ >= 0) close(log_);
}

// What the pause took counts neither as silence nor as the child's time: the work's clock stands.
void ChildOutput::PauseIfAsked() {
  if (!IsWorkHeld()) return;
  options_.stop(true);
  WaitWhilePaused();
  options_.stop(false);
}

// Until there is something to read.
void ChildOutput::WaitFor(int pipe) {
  while (true) {
    PauseIfAsked();
    const double now = WorkSeconds();
    const double silent = now - last_output_seconds_, all = now - start_seconds_;
    if (options_.timeout_seconds > 0 && all >= options_.timeout_seconds) {
      const std::string log = options_.log_path.empty()
                                  ? ""
                                  : "read its output in " + options_.log_path.string() + ", ";
      throw Error(options_.program.string(),
                  "has not ended within " + DurationText(options_.timeout_seconds) +
                      " (--colmap_timeout) and was stopped",
                  log + "raise --colmap_timeout, or run the same command again to continue");
    }
    if (silent >= next_silence_seconds_) {
      LogInfo(options_.program.filename().string() + " has printed nothing for " +
              DurationText(silent) + "; it is still at work");
      next_silence_seconds_ *= 2;
    }
    double wait_seconds = next_silence_seconds_ - silent;
    if (options_.timeout_seconds > 0) {
      wait_seconds = std::min(wait_seconds, options_.timeout_seconds - all);
    }
    pollfd poll_pipe = {pipe, POLLIN, 0};
    const int wait_ms = static_cast<int>(std::ceil(std::clamp(wait_seconds, 0.0, 1.0) * 1000));
    if (poll(&poll_pipe, 1, wait_ms) > 0) break;
  }
  last_output_seconds_ = WorkSeconds();
  next_silence_seconds_ = options_.silence_seconds;
}

void ChildOutput::WriteLog(const char* data, size_t size) {
  while (size > 0) {
    const ssize_t written = write(log_, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw SystemError(options_.log_path, "cannot be written", errno);
    data += written;
    size -= static_cast<size_t>(written);
  }
}

void ChildOutput::Log(const char* data, size_t size) {
  if (log_ < 0 || log_bytes_ >= kMaxLogBytes) return;
  WriteLog(data, static_cast<size_t>(std::min<uint64_t>(size, kMaxLogBytes - log_bytes_)));
  log_bytes_ += size;
  if (log_bytes_ >= kMaxLogBytes) WriteLog(kLogIsFull, sizeof(kLogIsFull) - 1);
}

void ChildOutput::Split(const char* data, size_t size) {
  for (const char* end = data + size; data != end;) {
    const char* const newline = std::find(data, end, '\n');
    const size_t room = kMaxLineBytes - line_.size();
    line_.append(data, std::min(room, static_cast<size_t>(newline - data)));
    if (newline == end) return;
    options_.on_line(line_);
    line_.clear();
    data = newline + 1;
  }
}

void ChildOutput::CopyFrom(int pipe) {
  std::vector<char> buffer(kReadBytes);
  while (true) {
    WaitFor(pipe);
    const ssize_t count = read(pipe, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    Log(buffer.data(), static_cast<size_t>(count));
    if (options_.on_line) Split(buffer.data(), static_cast<size_t>(count));
  }
  if (options_.on_line && !line_.empty()) options_.on_line(line_);
}

}  // namespace colmap_seapoint
