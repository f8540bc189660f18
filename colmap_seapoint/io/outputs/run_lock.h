// One run at a time on one output.
#pragma once

#include <filesystem>
#include <string>

namespace colmap_seapoint {

// Holds the lock file `path` from its construction to its end, and removes it then. The system ends
// the lock of a run that is killed, as soon as the programs that it had started have ended too; the
// file that such a run leaves stops nobody. A file system without locks stops nobody either.
class RunLock {
 public:
  // Waits up to a second for a run that is about to end. Throws Error when another run holds it
  // ("<what>: another run is at work there; <remedy>") or the file cannot be created.
  RunLock(const std::filesystem::path& path, const std::filesystem::path& what,
          const std::string& remedy);
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
