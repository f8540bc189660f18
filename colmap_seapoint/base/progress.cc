#include "colmap_seapoint/base/progress.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <system_error>
#include <vector>

#include "colmap_seapoint/base/hold/quiet_thread.h"
#include "colmap_seapoint/base/hold/work_clock.h"

namespace colmap_seapoint {
namespace {

constexpr double kRewriteSeconds = 0.2;
constexpr double kPlainLineSeconds = 10;
constexpr double kPlainLineShare = 0.1;
constexpr double kRewriteBeatSeconds = 1;

using Clock = std::chrono::steady_clock;

std::atomic<int> log_level{static_cast<int>(LogLevel::kInfo)};
std::mutex stderr_mutex;
bool line_is_open = false;                   // a rewriting progress line stands on the terminal
Clock::time_point last_word = Clock::now();  // on stderr, of whatever kind

// Those that live, the innermost last. Held while one is asked what it says.
std::mutex parts_mutex;
std::vector<const Progress*> parts;
std::atomic<WorkObserver*> observer{nullptr};
std::mutex observer_mutex;  // held while the heartbeat asks the observer, which may be leaving
const Clock::time_point program_start = Clock::now();

bool IsEnabled(LogLevel level) {
  if (ThisThreadIsQuiet() && level != LogLevel::kError) return false;
  return static_cast<int>(level) <= log_level.load();
}

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
  last_word = Clock::now();
}

void RewriteLine(const std::string& line) {
  std::lock_guard<std::mutex> lock(stderr_mutex);
  std::fprintf(stderr, "\r%s\033[K", Printable(line).c_str());
  std::fflush(stderr);
  line_is_open = true;
  last_word = Clock::now();
}

bool IsTerminal() {
  static const bool is_terminal = isatty(STDERR_FILENO) == 1;
  return is_terminal;
}

void ShowLine(const std::string& line) {
  if (IsTerminal()) {
    RewriteLine(line);
  } else {
    LogInfo(line);
  }
}

double Seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

double SecondsOfSilence() {
  std::lock_guard<std::mutex> lock(stderr_mutex);
  return Seconds(Clock::now() - last_word);
}

bool HasSomethingToCount() {
  std::lock_guard<std::mutex> lock(parts_mutex);
  return observer != nullptr || !parts.empty();
}

// Seconds of silence after which something is said where nobody has asked for it.
double LongestSilence() {
  if (IsTerminal()) return kRewriteBeatSeconds;
  std::lock_guard<std::mutex> lock(observer_mutex);
  WorkObserver* const all = observer;
  return all != nullptr && !SomeThreadIsQuiet()
             ? std::min(all->SecondsBetweenLines(), kMaxSilenceSeconds)
             : kMaxSilenceSeconds;
}

// What is said then. A part that has ended leaves silence behind it, too.
std::string PresentLine() {
  {
    std::lock_guard<std::mutex> lock(observer_mutex);
    if (WorkObserver* const all = observer) return all->Line();
  }
  std::lock_guard<std::mutex> lock(parts_mutex);
  if (!parts.empty()) return parts.back()->Line();
  return "Working since " + DurationText(Seconds(Clock::now() - program_start));
}

// Says how far the work is where nothing has been said for long, or, on a terminal, where the
// rewriting line is old.
void ShowIfSilent() {
  if (!IsEnabled(LogLevel::kInfo)) return;
  if (SecondsOfSilence() < LongestSilence()) return;
  if (IsTerminal() && !HasSomethingToCount()) return;
  ShowLine(PresentLine());
}

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

void SetWorkObserver(WorkObserver* of_all_work) {
  std::lock_guard<std::mutex> lock(observer_mutex);
  observer = of_all_work;
}

Progress::Progress(const std::string& label, int64_t total, int64_t already_done, Work work)
    : label_(label),
      total_(total),
      already_done_(already_done),
      work_(work),
      start_seconds_(WorkSeconds()),
      last_line_(Clock::now()),
      last_done_(already_done),
      done_(already_done) {
  if (WorkObserver* const all = observer) all->Begin(work_, label_, total_, already_done_);
  std::lock_guard<std::mutex> lock(parts_mutex);
  parts.push_back(this);
}

Progress::~Progress() {
  if (WorkObserver* const all = observer; all != nullptr && !finished_) all->End(work_);
  {
    std::lock_guard<std::mutex> lock(parts_mutex);
    parts.erase(std::find(parts.begin(), parts.end(), this));
  }
  std::lock_guard<std::mutex> lock(stderr_mutex);
  if (!finished_) WipeOpenLine();
}

std::string Progress::Line() const {
  const int64_t done = done_;
  const double percent =
      total_ > 0 ? 100.0 * static_cast<double>(done) / static_cast<double>(total_) : 100;
  char numbers[96];
  std::snprintf(numbers, sizeof(numbers), ": %lld of %lld (%.0f %%)", static_cast<long long>(done),
                static_cast<long long>(total_), percent);
  std::string line = label_ + numbers;
  const int64_t done_here = done - already_done_;
  if (done_here > 0 && done < total_) {
    const double left = (WorkSeconds() - start_seconds_) * static_cast<double>(total_ - done) /
                        static_cast<double>(done_here);
    line += ", " + DurationText(left) + " left";
  }
  return line;
}

void Progress::Update(int64_t done) {
  if (finished_) return;
  done_ = done;
  WorkObserver* const all = observer;
  if (all != nullptr) all->Advance(work_, done);
  if (!IsEnabled(LogLevel::kInfo)) return;
  const auto now = Clock::now();
  const double since_line = all != nullptr ? SecondsOfSilence() : Seconds(now - last_line_);
  const double further =
      static_cast<double>(done - last_done_) / static_cast<double>(total_ > 0 ? total_ : 1);
  const bool is_due = IsTerminal() ? since_line >= kRewriteSeconds
                      : all != nullptr
                          ? since_line >= all->SecondsBetweenLines()
                          : since_line >= kPlainLineSeconds && further >= kPlainLineShare;
  if (!is_due) return;
  ShowLine(all != nullptr ? all->Line() : Line());
  last_line_ = now;
  last_done_ = done;
}

void Progress::Finish() {
  if (finished_) return;
  finished_ = true;
  if (WorkObserver* const all = observer) all->End(work_);
  LogInfo(label_ + ": " + std::to_string(total_) + " in " +
          DurationText(WorkSeconds() - start_seconds_));
}

Heartbeat::Heartbeat() {
  thread_ = StartWithoutSignals([this] {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ended_.wait_for(lock, kBeat, [this] { return is_over_; })) {
      TellWorkClock(Beat::kNow);
      ShowIfSilent();
    }
    TellWorkClock(Beat::kBeatsEnd);
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
