// Runs a program as a user does, and looks at what it leaves.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/faults/fault_injector.h"

namespace colmap_seapoint {

struct CliOptions {
  std::map<std::string, std::string> environment;  // added to ours
  bool as_nobody = false;                          // gives up root (of a test run as root)
  long max_file_bytes = 0;                         // no file may grow beyond it; 0 = no limit
  long max_processes = 0;                          // RLIMIT_NPROC, threads too; 0 = no limit
  long max_address_bytes = 0;                      // RLIMIT_AS; 0 = no limit
  std::vector<int> closed_descriptors;             // closed by who starts it: 0, 1, 2
  std::string out_path;                            // where stdout goes; empty = into `out`
  double timeout_seconds = 60;                     // then it is killed
  // Sent kill_signal as soon as this says so, once; asked every few milliseconds with the seconds
  // since the start.
  std::function<bool(double)> kill_when;
  int kill_signal = 9;
  std::optional<Fault> fault;
};

struct CliResult {
  int exit_code = -1;  // -1: it did not exit by itself
  int signal_number = 0;
  bool timed_out = false;
  uint64_t peak_rss_bytes = 0;
  FaultCounts faults;  // of `fault`
  std::string out, err;

  std::string LastErrorLine() const;
  // For messages: everything.
  std::string Text() const;
};

CliResult RunProgram(const std::string& program, const std::vector<std::string>& arguments,
                     const CliOptions& options = {});

// A folder of its own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& Path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

std::string ReadBytes(const std::filesystem::path& path);
void WriteBytes(const std::filesystem::path& path, const std::string& bytes);

// Relative path -> bytes of every file below `folder`.
std::map<std::string, std::string> ReadTree(const std::filesystem::path& folder);

// Whether it is what a run that is killed leaves for the next one to clear away: a temporary file,
// or a lock.
bool IsLeftover(const std::filesystem::path& path);
// Whether a temporary file of a run lies in `folder`, or below it.
bool HoldsTemporaryFile(const std::filesystem::path& folder);

bool ProcessIsAlive(pid_t process);

}  // namespace colmap_seapoint
