#include "colmap_seapoint/io/outputs/run_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr int kAttempts = 10;
constexpr std::chrono::milliseconds kPause{100};

enum class Attempt { kLocked, kBusy, kReplaced };

// Who held the lock before may have removed the file by now: then the lock of what we have open
// means nothing.
bool IsStillThere(const std::filesystem::path& path, int descriptor) {
  struct stat opened {
  }, named{};
  return fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

Attempt TryLock(const std::filesystem::path& path, int descriptor) {
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) {
    return IsStillThere(path, descriptor) ? Attempt::kLocked : Attempt::kReplaced;
  }
  const bool knows_locks = errno == EWOULDBLOCK || errno == EINTR;
  return knows_locks ? Attempt::kBusy : Attempt::kLocked;
}

// Which had no time for a last word: whoever finds its log wants to know. Of a workspace alone, not
// of each folder in it.
void TellOfInterruptedRun(const std::filesystem::path& what) {
  LogInfo(what.string() +
          ": the run before did not come to its end (stopped, killed, for want of memory or of "
          "power); this one goes on from there");
}

}  // namespace

RunLock::RunLock(const std::filesystem::path& path, const std::filesystem::path& what,
                 const std::string& remedy, IfBusy if_busy)
    : path_(path) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const bool was_there = access(path.c_str(), F_OK) == 0;
    descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (descriptor_ < 0) {
      throw Error(path.string(), "cannot be created (" + SystemText(errno) + ")", remedy);
    }
    const Attempt result = TryLock(path, descriptor_);
    if (result == Attempt::kLocked) {
      if (was_there && if_busy == IfBusy::kWaitForChildren) TellOfInterruptedRun(what);
      return;
    }
    close(descriptor_);
    if (result != Attempt::kBusy) continue;
    if (if_busy == IfBusy::kRefuse) break;
    std::this_thread::sleep_for(kPause);
  }
  throw Error(what.string(), "another run is at work there", "wait for it to end, or " + remedy);
}

// Removed while it is held: nobody else can hold the file of that name.
RunLock::~RunLock() {
  unlink(path_.c_str());
  close(descriptor_);
}

RunLock LockFile(const std::filesystem::path& file, const std::string& option) {
  return RunLock(file.string() + ".lock", file, "choose another " + option);
}

}  // namespace colmap_seapoint
