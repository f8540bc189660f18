#include "tests/cli/cli_runner.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr uid_t kNobody = 65534;
constexpr auto kPoll = std::chrono::milliseconds(2);

void RedirectTo(const fs::path& path, int descriptor) {
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  dup2(file, descriptor);
}

void Limit(int resource, long value) {
  const rlimit limit = {static_cast<rlim_t>(value), static_cast<rlim_t>(value)};
  if (value > 0) setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

[[noreturn]] void Execute(const std::string& program, const std::vector<std::string>& arguments,
                          const CliOptions& options, const fs::path& out, const fs::path& err,
                          FaultInjector* injector) {
  RedirectTo(options.out_path.empty() ? out : fs::path(options.out_path), STDOUT_FILENO);
  RedirectTo(err, STDERR_FILENO);
  for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
  Limit(RLIMIT_FSIZE, options.max_file_bytes);
  Limit(RLIMIT_NPROC, options.max_processes);
  Limit(RLIMIT_AS, options.max_address_bytes);
  if (options.as_nobody && (setgid(kNobody) != 0 || setuid(kNobody) != 0)) _exit(125);
  std::vector<char*> texts = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    texts.push_back(const_cast<char*>(argument.c_str()));
  texts.push_back(nullptr);
  if (injector != nullptr) injector->StartInChild();
  for (const int descriptor : options.closed_descriptors) close(descriptor);
  execv(program.c_str(), texts.data());
  _exit(126);
}

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

std::string CliResult::LastErrorLine() const {
  std::istringstream lines(err);
  std::string last;
  for (std::string line; std::getline(lines, line);) last = line;
  return last;
}

std::string CliResult::Text() const {
  return "exit code " + std::to_string(exit_code) + ", signal " + std::to_string(signal_number) +
         (timed_out ? ", timed out" : "") + "\nstdout: " + out + "\nstderr: " + err;
}

CliResult RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                     const CliOptions& options) {
  const TemporaryFolder folder;
  const auto start = Clock::now();
  std::optional<FaultInjector> injector;
  if (options.fault) injector.emplace(*options.fault);
  const pid_t child = fork();
  if (child == 0) {
    Execute(program, arguments, options, folder / "out", folder / "err",
            injector ? &*injector : nullptr);
  }
  if (injector) injector->Watch(child);
  CliResult result;
  bool is_killed = false;
  int status = 0;
  rusage usage{};
  while (wait4(child, &status, WNOHANG, &usage) == 0) {
    const double seconds = SecondsSince(start);
    result.timed_out = seconds > options.timeout_seconds;
    if (result.timed_out) kill(child, SIGKILL);
    if (!is_killed && options.kill_when && options.kill_when(seconds)) {
      kill(child, options.kill_signal);
      is_killed = true;
    }
    std::this_thread::sleep_for(kPoll);
  }
  if (injector) result.faults = injector->Finish();
  result.peak_rss_bytes = 1024 * static_cast<uint64_t>(usage.ru_maxrss);
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal_number = WTERMSIG(status);
  result.out = ReadBytes(folder / "out");
  result.err = ReadBytes(folder / "err");
  return result;
}

TemporaryFolder::TemporaryFolder() {
  std::string path = (fs::temp_directory_path() / "seapoint_cli_XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr) throw std::runtime_error("no temporary folder");
  fs::permissions(path, fs::perms::owner_all | fs::perms::group_read | fs::perms::group_exec |
                            fs::perms::others_read | fs::perms::others_exec);
  path_ = path;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string ReadBytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

void WriteBytes(const fs::path& path, const std::string& bytes) {
  fs::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::map<std::string, std::string> ReadTree(const fs::path& folder) {
  std::map<std::string, std::string> tree;
  if (!fs::exists(folder)) return tree;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      tree[fs::relative(entry.path(), folder).string()] = ReadBytes(entry.path());
    }
  }
  return tree;
}

bool IsLeftover(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  const bool is_temporary = name.rfind(".seapoint_", 0) == 0 && path.extension() == ".tmp";
  return is_temporary || name == ".colmap_seapoint.lock";
}

bool HoldsTemporaryFile(const std::filesystem::path& folder) {
  std::error_code error;  // what vanishes meanwhile
  std::filesystem::recursive_directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    if (IsLeftover(entry->path()) && entry->path().extension() == ".tmp") return true;
  }
  return false;
}

bool ProcessIsAlive(pid_t process) {
  // A zombie that nobody has waited for is dead.
  std::ifstream status("/proc/" + std::to_string(process) + "/stat");
  std::string text((std::istreambuf_iterator<char>(status)), std::istreambuf_iterator<char>());
  const size_t end = text.rfind(')');
  return end != std::string::npos && end + 2 < text.size() && text[end + 2] != 'Z';
}

}  // namespace colmap_seapoint
