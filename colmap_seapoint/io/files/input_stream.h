// Files to read from, where a disk that fails is never taken for the end of the file.
#pragma once

#include <filesystem>
#include <istream>
#include <memory>
#include <string>
#include <vector>

namespace colmap_seapoint {

// As std::ifstream in binary mode, but for its errors: the constructor and every reading throw
// Error with the path and what the system said. What a disk has failed to give is no end of the
// file: that alone ends a loop. Opening what is neither a file nor a pipe is an error too.
class InputStream : public std::istream {
 public:
  explicit InputStream(const std::filesystem::path& path);
  ~InputStream() override;
  InputStream(const InputStream&) = delete;
  InputStream& operator=(const InputStream&) = delete;

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
};

// nullptr when there is no such file; whatever else keeps it from being opened is an Error.
std::unique_ptr<InputStream> OpenIfThere(const std::filesystem::path& path);

}  // namespace colmap_seapoint
