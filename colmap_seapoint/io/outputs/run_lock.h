// One run at a time on one output.
#pragma once

#include <filesystem>
#include <string>

namespace colmap_seapoint {

// Programs that a killed run had started, and their guard, need a moment to end.
enum class IfBusy { kRefuse, kWaitForChildren };

// Holds the lock file `path` from its construction to its end, and removes it then. The system ends
// the lock of a run that is killed, as soon as the programs that it had started have ended too; the
// file that such a run leaves stops nobody. A file system without locks stops nobody either.
class RunLock {
 public:
  // Throws Error when another run holds it ("<what>: another run is at work there; <remedy>"), with
  // kWaitForChildren after a second, or when the file cannot be created.
  RunLock(const std::filesystem::path& path, const std::filesystem::path& what,
          const std::string& remedy, IfBusy if_busy = IfBusy::kRefuse);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  int Descriptor() const { return descriptor_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

// The lock of an output that is a single file: "<file>.lock". `option` is where it is named.
RunLock LockFile(const std::filesystem::path& file, const std::string& option);

}  // namespace colmap_seapoint
