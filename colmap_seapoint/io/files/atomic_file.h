// A file that appears whole or not at all: written beside its place under a temporary name,
// flushed to the disk, then renamed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <istream>
#include <string>

namespace colmap_seapoint {

class AtomicFile {
 public:
  // Creates a file of a random name beside it (temporary_file.h). Throws Error (where, why, remedy)
  // when it cannot.
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();  // removes the temporary file unless Commit() was called
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(const void* data, size_t size);  // throws Error, e.g. on a full disk
  void Write(const std::string& text) { Write(text.data(), text.size()); }
  void WriteRest(std::istream* from);  // all that is still to be read there
  void WriteAt(uint64_t offset, const void* data, size_t size);  // overwrites, then back to the end
  uint64_t Size() const { return size_; }
  void Commit();  // fsync, close, rename

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_path_;
  std::FILE* file_ = nullptr;
  uint64_t size_ = 0;
};

// Writes `text` to `path` atomically.
void WriteTextFile(const std::filesystem::path& path, const std::string& text);

// The bytes of one file under another name, atomically. Throws Error; also when `to` is `from`
// itself, by a link: a copy over the original is never meant.
void CopyFileAtomically(const std::filesystem::path& from, const std::filesystem::path& to);

// Throws Error when no file could be created in `dir` (which is created when missing). What killed
// runs left in it is removed (temporary_file.h).
void CheckWritableDir(const std::filesystem::path& dir);

}  // namespace colmap_seapoint
