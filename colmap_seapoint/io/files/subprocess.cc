#include "colmap_seapoint/io/files/subprocess.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/child_output.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr int kCannotStart = 127;  // exit code of the guard, as of a shell
constexpr int kSignalsOfScripts = 128;

bool IsExecutableFile(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && access(path.c_str(), X_OK) == 0;
}

class FileDescriptor {
 public:
  explicit FileDescriptor(int descriptor = -1) : descriptor_(descriptor) {}
  ~FileDescriptor() { Close(); }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int Get() const { return descriptor_; }
  void Close() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
  }

 private:
  int descriptor_;
};

// Everything the guard and the program need, built before fork(): after it, in a process that may
// have had threads, only async-signal-safe calls are allowed.
struct LaunchPlan {
  std::vector<std::string> argument_texts;
  std::vector<std::string> environment_texts;
  std::vector<char*> arguments;
  std::vector<char*> environment;
  pid_t parent = 0;
  int output = -1;      // write end of the pipe
  int null_input = -1;  // /dev/null
  sigset_t all_signals;
};

LaunchPlan MakePlan(const std::filesystem::path& program,
                    const std::vector<std::string>& arguments) {
  static constexpr char kPlatform[] = "QT_QPA_PLATFORM=";
  LaunchPlan plan;
  plan.argument_texts.push_back(program.string());
  for (const std::string& argument : arguments) plan.argument_texts.push_back(argument);
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (std::strncmp(*entry, kPlatform, sizeof(kPlatform) - 1) != 0) {
      plan.environment_texts.push_back(*entry);
    }
  }
  plan.environment_texts.push_back(std::string(kPlatform) + "offscreen");
  for (std::string& text : plan.argument_texts) plan.arguments.push_back(text.data());
  for (std::string& text : plan.environment_texts) plan.environment.push_back(text.data());
  plan.arguments.push_back(nullptr);
  plan.environment.push_back(nullptr);
  plan.parent = getpid();
  sigfillset(&plan.all_signals);
  return plan;
}

extern "C" void KillOwnGroup(int /*signal_number*/) { kill(0, SIGKILL); }

[[noreturn]] void RunProgram(const LaunchPlan& plan) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // SIGXFSZ too: who does not look at what write() returns had better be ended by it.
  for (int number : {SIGTERM, SIGINT, SIGHUP, SIGPIPE, SIGXFSZ}) signal(number, SIG_DFL);
  dup2(plan.null_input, STDIN_FILENO);
  dup2(plan.output, STDOUT_FILENO);
  dup2(plan.output, STDERR_FILENO);
  execve(plan.arguments[0], plan.arguments.data(), plan.environment.data());
  _exit(kCannotStart);
}

// The guard: leads the process group, waits for the program, and kills the whole group when our
// own death is signalled to it. It answers with the program's own end.
[[noreturn]] void RunGuard(const LaunchPlan& plan) {
  setpgid(0, 0);
  struct sigaction action {};
  action.sa_handler = KillOwnGroup;
  for (int number : {SIGTERM, SIGINT, SIGHUP}) sigaction(number, &action, nullptr);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  if (getppid() != plan.parent) _exit(kCannotStart);  // we died before prctl
  const pid_t program = fork();
  if (program == 0) RunProgram(plan);
  close(plan.output);
  int status = 0;
  while (program > 0 && waitpid(program, &status, 0) < 0 && errno == EINTR) {
  }
  if (program < 0) _exit(kCannotStart);
  if (WIFSIGNALED(status)) {
    signal(WTERMSIG(status), SIG_DFL);
    raise(WTERMSIG(status));
  }
  _exit(WIFEXITED(status) ? WEXITSTATUS(status) : kCannotStart);
}

pid_t StartGuard(const LaunchPlan& plan) {
  // No handler of ours may run in the guard between fork() and its own set-up.
  sigset_t before;
  pthread_sigmask(SIG_SETMASK, &plan.all_signals, &before);
  const pid_t guard = fork();
  if (guard == 0) RunGuard(plan);
  const int error_number = errno;
  if (guard > 0) setpgid(guard, guard);  // here too: whoever is first
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (guard < 0) {
    throw SystemError(plan.argument_texts[0], "cannot be started", error_number);
  }
  return guard;
}

SubprocessResult WaitForGuard(pid_t guard) {
  int status = 0;
  while (waitpid(guard, &status, 0) < 0 && errno == EINTR) {
  }
  SubprocessResult result;
  if (WIFSIGNALED(status)) result.signal_number = WTERMSIG(status);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  return result;
}

}  // namespace

std::filesystem::path FindProgram(const std::string& name, const std::string& remedy) {
  if (name.find('/') != std::string::npos) {
    if (IsExecutableFile(name)) return std::filesystem::absolute(name);
    throw Error(name, "is not an executable file", remedy);
  }
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path candidate = std::filesystem::path(folder) / name;
    if (!name.empty() && IsExecutableFile(candidate)) return std::filesystem::absolute(candidate);
  }
  throw Error(name, "no such program on PATH", remedy);
}

bool SubprocessResult::WasEndedByOthers() const {
  const int number = signal_number != 0 ? signal_number : exit_code - kSignalsOfScripts;
  return number == SIGKILL || number == SIGTERM || number == SIGINT || number == SIGHUP;
}

std::string SubprocessResult::Text() const {
  if (signal_number == 0) return "exit code " + std::to_string(exit_code);
  return "killed by signal " + std::to_string(signal_number) + " (" + strsignal(signal_number) +
         ")";
}

SubprocessResult RunSubprocess(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments,
                               const std::filesystem::path& log_path,
                               const std::function<void(const std::string&)>& on_line,
                               double timeout_seconds) {
  LaunchPlan plan = MakePlan(program, arguments);
  ChildOutputOptions of_output = {program, log_path, on_line, timeout_seconds};
  pid_t guard = 0;
  of_output.stop = [&guard](bool is_stopped) { kill(-guard, is_stopped ? SIGSTOP : SIGCONT); };
  ChildOutput output(of_output);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw SystemError(program, "no pipe to it", errno);
  const FileDescriptor read_end(ends[0]);
  FileDescriptor write_end(ends[1]);
  const FileDescriptor null_input(open("/dev/null", O_RDONLY | O_CLOEXEC));
  plan.output = write_end.Get();
  plan.null_input = null_input.Get();
  guard = StartGuard(plan);
  write_end.Close();
  try {
    output.CopyFrom(read_end.Get());
  } catch (...) {
    kill(-guard, SIGKILL);
    WaitForGuard(guard);
    throw;
  }
  return WaitForGuard(guard);
}

}  // namespace colmap_seapoint
