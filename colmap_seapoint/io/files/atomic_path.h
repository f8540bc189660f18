// A file that a library writes by its name, and that appears whole or not at all.
#pragma once

#include <filesystem>

namespace colmap_seapoint {

// An empty temporary file (temporary_file.h) beside `path`. A library may open it by its name,
// write it and close it, but not remove it or put another one there. Whatever is done with it,
// nothing of it is left unless Commit() was called.
class AtomicPath {
 public:
  // Throws Error (where, why, remedy) when the file cannot be created, or `path` is a folder.
  explicit AtomicPath(const std::filesystem::path& path);
  ~AtomicPath();
  AtomicPath(const AtomicPath&) = delete;
  AtomicPath& operator=(const AtomicPath&) = delete;

  const std::filesystem::path& Path() const { return path_; }  // the final one
  const std::filesystem::path& Temporary() const { return temporary_; }
  // Why the file cannot grow, as the system says it when asked, for libraries that do not tell; 0:
  // it can.
  int GrowthError() const;
  // fsync, rename. Throws Error, e.g. when the disk does not take what was written.
  void Commit();

 private:
  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;  // holds the lock that keeps the file from being taken for a leftover
};

}  // namespace colmap_seapoint
