#include "colmap_seapoint/io/files/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_path.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/io/files/temporary_file.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kBufferBytes = 1 << 18;

// The rename itself must reach the disk too. A file system that cannot sync folders is no error.
void SyncParentFolder(const std::filesystem::path& path) {
  const std::filesystem::path parent = path.parent_path();
  const int folder = open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY);
  if (folder < 0) return;
  fsync(folder);
  close(folder);
}

TemporaryFile CreateBeside(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw SystemError(path, "is a folder", EISDIR);
  }
  const std::filesystem::path parent = path.parent_path();
  TemporaryFile temporary = CreateTemporaryFile(parent.empty() ? "." : parent);
  if (temporary.descriptor < 0) throw SystemError(path, "cannot be created", errno);
  return temporary;
}

void RenameInto(const std::filesystem::path& temporary, const std::filesystem::path& path) {
  if (std::rename(temporary.c_str(), path.c_str()) != 0) {
    throw SystemError(path, "cannot be put in its place", errno);
  }
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& path) : path_(path) {
  const TemporaryFile temporary = CreateBeside(path_);
  temporary_path_ = temporary.path;
  file_ = fdopen(temporary.descriptor, "wb");
  if (file_ == nullptr) {
    const int error_number = errno;
    unlink(temporary_path_.c_str());
    close(temporary.descriptor);
    throw SystemError(path_, "cannot be created", error_number);
  }
  std::setvbuf(file_, nullptr, _IOFBF, kBufferBytes);
}

// It is closed last, since its lock protects the temporary file until then.
AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  unlink(temporary_path_.c_str());
  std::fclose(file_);
}

void AtomicFile::Write(const void* data, size_t size) {
  SEAPOINT_CHECK(file_ != nullptr);
  if (size == 0) return;
  if (std::fwrite(data, 1, size, file_) != size)
    throw SystemError(path_, "cannot be written", errno);
  size_ += size;
}

void AtomicFile::WriteRest(std::istream* from) {
  std::vector<char> buffer(kBufferBytes);
  while (const std::streamsize size = from->rdbuf()->sgetn(buffer.data(), kBufferBytes)) {
    Write(buffer.data(), static_cast<size_t>(size));
  }
}

void AtomicFile::WriteAt(uint64_t offset, const void* data, size_t size) {
  SEAPOINT_CHECK(file_ != nullptr);
  SEAPOINT_CHECK(offset <= size_ && size <= size_ - offset);
  if (fseeko(file_, static_cast<off_t>(offset), SEEK_SET) != 0 ||
      std::fwrite(data, 1, size, file_) != size || fseeko(file_, 0, SEEK_END) != 0) {
    throw SystemError(path_, "cannot be written", errno);
  }
}

void AtomicFile::Commit() {
  SEAPOINT_CHECK(file_ != nullptr);
  if (std::fflush(file_) != 0 || fsync(fileno(file_)) != 0) {
    throw SystemError(path_, "cannot be written", errno);
  }
  RenameInto(temporary_path_, path_);
  // fsync() has said that all is on the disk: closing has nothing to add.
  std::fclose(file_);
  file_ = nullptr;
  SyncParentFolder(path_);
}

AtomicPath::AtomicPath(const std::filesystem::path& path) : path_(path) {
  const TemporaryFile temporary = CreateBeside(path_);
  temporary_ = temporary.path;
  descriptor_ = temporary.descriptor;
}

// As with AtomicFile: its lock ends last.
AtomicPath::~AtomicPath() {
  if (descriptor_ < 0) return;
  unlink(temporary_.c_str());
  close(descriptor_);
}

int AtomicPath::GrowthError() const {
  static constexpr char kBytes[1 << 16] = {};
  struct stat status {};
  if (fstat(descriptor_, &status) != 0) return errno;
  const ssize_t written = pwrite(descriptor_, kBytes, sizeof(kBytes), status.st_size);
  if (written < 0) return errno;
  return written < static_cast<ssize_t>(sizeof(kBytes)) ? ENOSPC : 0;
}

void AtomicPath::Commit() {
  SEAPOINT_CHECK(descriptor_ >= 0);
  struct stat ours {
  }, there{};
  SEAPOINT_CHECK(fstat(descriptor_, &ours) == 0 && stat(temporary_.c_str(), &there) == 0 &&
                 ours.st_ino == there.st_ino);
  if (fsync(descriptor_) != 0) throw SystemError(path_, "cannot be written", errno);
  RenameInto(temporary_, path_);
  close(descriptor_);
  descriptor_ = -1;
  SyncParentFolder(path_);
}

void WriteTextFile(const std::filesystem::path& path, const std::string& text) {
  AtomicFile file(path);
  file.Write(text);
  file.Commit();
}

void CopyFileAtomically(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code ignored;
  if (std::filesystem::equivalent(from, to, ignored)) {
    throw Error(to.string(), "is a link to the original " + from.string(),
                "remove it, or choose another folder");
  }
  InputStream source(from);
  AtomicFile file(to);
  file.WriteRest(&source);
  file.Commit();
}

void CheckWritableDir(const std::filesystem::path& dir) {
  std::error_code error;
  const bool exists = std::filesystem::exists(dir, error);
  if (exists && !std::filesystem::is_directory(dir, error)) {
    throw Error(dir.string(), "is a file, not a folder", "choose another folder");
  }
  if (!exists) {
    error.clear();
    std::filesystem::create_directories(dir, error);
    if (error) throw SystemError(dir, "the folder cannot be created", error.value());
  }
  RemoveLeftovers(dir);
  const TemporaryFile probe = CreateTemporaryFile(dir);
  if (probe.descriptor < 0) throw SystemError(dir, "no file can be created in this folder", errno);
  const bool written = write(probe.descriptor, "", 1) == 1;  // one byte is never written in part
  const int error_number = errno;
  unlink(probe.path.c_str());
  close(probe.descriptor);
  if (!written) throw SystemError(dir, "no file can be written in this folder", error_number);
}

}  // namespace colmap_seapoint
