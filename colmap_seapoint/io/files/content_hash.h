// Hashes that tell whether bytes changed (64-bit XXH3). They are no protection against intent.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

struct XXH3_state_s;

namespace colmap_seapoint {

// The hash of bytes that come piece by piece; it is the same however they are cut.
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;

  void Add(const void* data, size_t size);
  std::string Text() const;

 private:
  XXH3_state_s* state_;
};

// "xxh3-" and 16 hex digits each; HashFile(path) is HashBytes() of the file's contents.
std::string HashBytes(const void* data, size_t size);
std::string HashText(const std::string& text);
// Whether `hash` is that of these bytes, as this version or an earlier one wrote it.
bool IsHashOf(const std::string& hash, const void* data, size_t size);
// Throws Error for a file that cannot be read to its end.
std::string HashFile(const std::filesystem::path& path);
// For files of many gigabytes: of the size, and of up to 64 blocks of 1 MiB spread evenly from the
// first to the last; of a file of 64 MiB and less, that is all of it.
std::string HashSamplesOfFile(const std::filesystem::path& path);

}  // namespace colmap_seapoint
