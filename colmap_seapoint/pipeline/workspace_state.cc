#include "colmap_seapoint/pipeline/workspace_state.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

// A killed run's programs need a moment to end.
constexpr int kLockAttempts = 20;
constexpr std::chrono::milliseconds kLockPause{100};

bool TakeLock(int lock) {
  for (int attempt = 0; attempt < kLockAttempts; ++attempt) {
    if (flock(lock, LOCK_EX | LOCK_NB) == 0) return true;
    if (errno != EWOULDBLOCK && errno != EINTR) return true;  // a file system without locks
    std::this_thread::sleep_for(kLockPause);
  }
  return false;
}

}  // namespace

WorkspaceState::WorkspaceState(const std::filesystem::path& workspace)
    : folder_(workspace / "state") {
  CheckWritableDir(workspace);
  CheckWritableDir(folder_);
  const std::string lock_path = (folder_ / "lock").string();
  lock_ = open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) {
    throw Error(lock_path, std::string("cannot be opened (") + std::strerror(errno) + ")",
                "choose a --workspace_path that you may write to");
  }
  if (TakeLock(lock_)) return;
  close(lock_);
  throw Error(workspace.string(), "another run is at work in this workspace",
              "wait for it to end, or choose another --workspace_path");
}

WorkspaceState::~WorkspaceState() { close(lock_); }

std::filesystem::path WorkspaceState::PathOf(const std::string& stage) const {
  return folder_ / (stage + ".json");
}

std::optional<RunReport> WorkspaceState::Read(const std::string& stage) const {
  return ReadRunReport(PathOf(stage));
}

std::optional<RunReport> WorkspaceState::ReadIfDone(const std::string& stage,
                                                    const std::string& fingerprint) const {
  auto report = Read(stage);
  if (report && report->fingerprint != fingerprint) report.reset();
  return report;
}

void WorkspaceState::Forget(const std::string& stage) {
  const std::filesystem::path path = PathOf(stage);
  std::error_code error;
  std::filesystem::remove(path, error);
  if (error) {
    throw Error(path.string(), "cannot be removed (" + error.message() + ")",
                "choose a --workspace_path that you may write to");
  }
}

void WorkspaceState::Finish(const std::string& stage, const std::string& fingerprint,
                            RunReport report) {
  syncfs(lock_);
  report.fingerprint = fingerprint;
  WriteRunReport(PathOf(stage), report);
}

}  // namespace colmap_seapoint
