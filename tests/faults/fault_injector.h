// A system that fails, for programs of ours that run as children, and for the children of those:
// their system calls are answered by the test (seccomp's user notification), so that stdio, SQLite
// and every library meet the failure where it happens.
#pragma once

#include <sys/types.h>

#include <cerrno>
#include <cstdint>
#include <set>
#include <string>
#include <thread>

namespace colmap_seapoint {

enum class SystemCall {
  kOpenToRead,
  kOpenToWrite,  // or to create
  kRead,         // of a file, or of a folder's names
  kWrite,
  kResize,
  kSync,
  kRename,
  kRemove,
  kMakeFolder,
  kMap,    // of a file, or of plain memory
  kStart,  // of a thread or a process
};

enum class FaultAction {
  kFail,     // with error_number
  kShorten,  // half of a read or a write is done; other calls are let through
  kKill,     // the program (not what it started) by SIGKILL, before the call is done
};

// Which calls, and what becomes of them. Calls without a path (plain memory, threads) count from
// the first call on that has a path which fits: before it the system's loader is at work.
struct Fault {
  std::set<SystemCall> calls = {SystemCall::kRead};
  std::string path_begin, path_end;  // of a rename, the new name's
  int64_t from_offset = 0;           // reads that begin here or behind
  int num_calls_before = 0;          // after so many of them that succeed
  int max_hits = 1 << 30;            // as often; then they succeed
  FaultAction action = FaultAction::kFail;
  int error_number = EIO;
};

struct FaultCounts {
  int num_calls = 0;  // that fit
  int num_hits = 0;
  std::string first_hit;  // for messages: "write <path>"
};

// One for each child.
class FaultInjector {
 public:
  explicit FaultInjector(const Fault& fault) : fault_(fault) {}
  ~FaultInjector();
  FaultInjector(const FaultInjector&) = delete;
  FaultInjector& operator=(const FaultInjector&) = delete;

  void StartInChild();      // in the child, before exec()
  void Watch(pid_t child);  // in the parent, after fork()
  // After the child has ended; waits for the end of what it had started.
  FaultCounts Finish();

 private:
  struct Call;
  void Answer(int listener);
  bool MustHit(const Call& call);

  const Fault fault_;
  pid_t child_ = 0;
  std::thread thread_;
  bool has_met_path_ = false;
  FaultCounts counts_;
};

// Whether this system lets a test answer its children's calls: some containers do not.
bool CanInjectFaults();

}  // namespace colmap_seapoint
