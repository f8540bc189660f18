#include "colmap_seapoint/io/files/input_stream.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <streambuf>

#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kBufferBytes = 1 << 16;

}  // namespace

class InputStream::Buffer : public std::streambuf {
 public:
  explicit Buffer(const std::filesystem::path& path)
      : path_(path), descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)), bytes_(kBufferBytes) {
    if (descriptor_ < 0) throw ReadError(path_, errno);
    struct stat status {};
    if (fstat(descriptor_, &status) == 0 && (S_ISREG(status.st_mode) || S_ISFIFO(status.st_mode))) {
      return;
    }
    close(descriptor_);
    if (S_ISDIR(status.st_mode)) throw ReadError(path_, EISDIR);
    throw Error(path_.string(), "cannot be read (it is a device)", "give a file");
  }
  ~Buffer() override { close(descriptor_); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

 protected:
  int_type underflow() override {
    ssize_t count = 0;
    do {
      count = ::read(descriptor_, bytes_.data(), bytes_.size());
    } while (count < 0 && errno == EINTR);
    if (count < 0) throw ReadError(path_, errno);
    end_ += count;
    setg(bytes_.data(), bytes_.data(), bytes_.data() + count);
    return count == 0 ? traits_type::eof() : traits_type::to_int_type(*gptr());
  }

  // For tellg() and for seekg() to a place counted from the start: nobody needs more.
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    if (from == std::ios_base::cur && offset == 0) return pos_type(end_ - (egptr() - gptr()));
    if (from != std::ios_base::beg) return pos_type(off_type(-1));
    return seekpos(pos_type(offset), std::ios_base::in);
  }

  pos_type seekpos(pos_type place, std::ios_base::openmode) override {
    const off_t at = lseek(descriptor_, static_cast<off_t>(place), SEEK_SET);
    if (at < 0) throw ReadError(path_, errno);
    end_ = at;
    setg(nullptr, nullptr, nullptr);
    return pos_type(at);
  }

 private:
  const std::filesystem::path path_;
  const int descriptor_;
  std::vector<char> bytes_;
  off_type end_ = 0;  // of what has been read
};

InputStream::InputStream(const std::filesystem::path& path)
    : std::istream(nullptr), buffer_(std::make_unique<Buffer>(path)) {
  rdbuf(buffer_.get());
  // So that what the buffer throws is passed on, not only noted.
  exceptions(std::ios_base::badbit);
}

InputStream::~InputStream() = default;

std::unique_ptr<InputStream> OpenIfThere(const std::filesystem::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 && (errno == ENOENT || errno == ENOTDIR)) return nullptr;
  return std::make_unique<InputStream>(path);
}

}  // namespace colmap_seapoint
