#include "colmap_seapoint/base/progress.h"

#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <mutex>

namespace colmap_seapoint {
namespace {

constexpr double kRewriteSeconds = 0.2;
constexpr double kPlainLineSeconds = 10;
constexpr double kPlainLineShare = 0.1;
constexpr double kPlainLineMaxSeconds = 60;

std::atomic<int> log_level{static_cast<int>(LogLevel::kInfo)};
std::mutex stderr_mutex;
bool line_is_open = false;  // a rewriting progress line stands on the terminal

bool IsEnabled(LogLevel level) { return static_cast<int>(level) <= log_level.load(); }

// Names of files can hold any byte: control characters would split the line, colour it or move the
// cursor, and are shown as they are written in C. The second half of those in two bytes of UTF-8
// (U+0080 to U+009F) too.
std::string Printable(const std::string& line) {
  std::string text;
  for (size_t i = 0; i < line.size(); ++i) {
    const auto byte = static_cast<unsigned char>(line[i]);
    const auto next = static_cast<unsigned char>(i + 1 < line.size() ? line[i + 1] : 0);
    const bool is_pair = byte == 0xc2 && next >= 0x80 && next < 0xa0;
    char escaped[8];
    if (byte == '\n') {
      text += "\\n";
    } else if (byte == '\t') {
      text += "\\t";
    } else if (byte < 0x20 || byte == 0x7f || is_pair) {
      std::snprintf(escaped, sizeof(escaped), is_pair ? "\\u%04x" : "\\x%02x",
                    is_pair ? next : byte);
      text += escaped;
      i += is_pair ? 1 : 0;
    } else {
      text += line[i];
    }
  }
  return text;
}

// Callers hold stderr_mutex.
void WipeOpenLine() {
  if (line_is_open) std::fputs("\r\033[K", stderr);
  line_is_open = false;
}

void LogLine(LogLevel level, const char* prefix, const std::string& line) {
  if (!IsEnabled(level)) return;
  std::lock_guard<std::mutex> lock(stderr_mutex);
  WipeOpenLine();
  std::fprintf(stderr, "%s%s\n", prefix, Printable(line).c_str());
}

void RewriteLine(const std::string& line) {
  std::lock_guard<std::mutex> lock(stderr_mutex);
  std::fprintf(stderr, "\r%s\033[K", Printable(line).c_str());
  std::fflush(stderr);
  line_is_open = true;
}

double Seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

void SetLogLevel(LogLevel level) { log_level = static_cast<int>(level); }
LogLevel GetLogLevel() { return static_cast<LogLevel>(log_level.load()); }

void LogError(const std::string& line) { LogLine(LogLevel::kError, "error: ", line); }
void LogWarning(const std::string& line) { LogLine(LogLevel::kWarning, "warning: ", line); }
void LogInfo(const std::string& line) { LogLine(LogLevel::kInfo, "", line); }
void LogDebug(const std::string& line) { LogLine(LogLevel::kDebug, "debug: ", line); }

std::string DurationText(double seconds) {
  const int64_t whole = std::isfinite(seconds) ? std::llround(std::fmin(seconds, 1e9)) : 0;
  char text[48];
  if (seconds < 10) {
    std::snprintf(text, sizeof(text), "%.1f s", seconds);
  } else if (whole < 60) {
    std::snprintf(text, sizeof(text), "%d s", static_cast<int>(whole));
  } else if (whole < 3600) {
    std::snprintf(text, sizeof(text), "%d min %02d s", static_cast<int>(whole / 60),
                  static_cast<int>(whole % 60));
  } else {
    std::snprintf(text, sizeof(text), "%d h %02d min", static_cast<int>(whole / 3600),
                  static_cast<int>(whole / 60 % 60));
  }
  return text;
}

Progress::Progress(const std::string& label, int64_t total, int64_t already_done)
    : label_(label),
      total_(total),
      already_done_(already_done),
      is_terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_line_(start_),
      last_done_(already_done) {}

Progress::~Progress() {
  std::lock_guard<std::mutex> lock(stderr_mutex);
  if (!finished_) WipeOpenLine();
}

std::string Progress::Line(int64_t done, double elapsed_seconds) const {
  const double percent =
      total_ > 0 ? 100.0 * static_cast<double>(done) / static_cast<double>(total_) : 100;
  char numbers[96];
  std::snprintf(numbers, sizeof(numbers), ": %lld of %lld (%.0f %%)", static_cast<long long>(done),
                static_cast<long long>(total_), percent);
  std::string line = label_ + numbers;
  const int64_t done_here = done - already_done_;
  if (done_here > 0 && done < total_) {
    const double left =
        elapsed_seconds * static_cast<double>(total_ - done) / static_cast<double>(done_here);
    line += ", " + DurationText(left) + " left";
  }
  return line;
}

void Progress::Update(int64_t done) {
  if (!IsEnabled(LogLevel::kInfo) || finished_) return;
  const auto now = Clock::now();
  const double since_line = Seconds(now - last_line_);
  const double further =
      static_cast<double>(done - last_done_) / static_cast<double>(total_ > 0 ? total_ : 1);
  const bool due = is_terminal_
                       ? since_line >= kRewriteSeconds
                       : since_line >= kPlainLineSeconds &&
                             (further >= kPlainLineShare || since_line >= kPlainLineMaxSeconds);
  if (!due) return;
  const std::string line = Line(done, Seconds(now - start_));
  if (is_terminal_) {
    RewriteLine(line);
  } else {
    LogInfo(line);
  }
  last_line_ = now;
  last_done_ = done;
}

void Progress::Finish() {
  if (finished_) return;
  finished_ = true;
  LogInfo(label_ + ": " + std::to_string(total_) + " in " +
          DurationText(Seconds(Clock::now() - start_)));
}

}  // namespace colmap_seapoint
