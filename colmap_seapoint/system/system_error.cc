#include "colmap_seapoint/system/system_error.h"

#include <cerrno>
#include <system_error>

namespace colmap_seapoint {
namespace {

std::string Remedy(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space or choose a folder on another disk";
    case EACCES:
    case EPERM:
      return "choose a folder that you may write to, or change its permissions";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first, or choose another one";
    case EISDIR:
      return "choose another name, or remove the folder of that name";
    case EMFILE:
    case ENFILE:
      return "close other programs, or raise the limit of open files (ulimit -n)";
    case EROFS:  // as file systems become whose disk fails
      return "if the disk was pulled or fails, put it back or check its cable, and run again; else "
             "choose a folder that you may write to";
    case ENOMEM:  // and what a folder on a disk that is gone answers
      return "close other programs, or use fewer --num_threads; if the disk was pulled, put it "
             "back";
    case EAGAIN:
      return "end other programs, or raise the limit of processes (ulimit -u)";
    case EIO:
      return "check the disk and its cable, and run again";
    default:
      return "check the path and the disk";
  }
}

std::string ReadRemedy(int error_number) {
  switch (error_number) {
    case ENOENT:
    case ENOTDIR:
    case ELOOP:
      return "check the path";
    case EACCES:
    case EPERM:
      return "check the path and the file's permissions";
    case EISDIR:
      return "give a file in it";
    default:
      return Remedy(error_number);
  }
}

std::string Finding(const std::string& what, int error_number) {
  return what + " (" + SystemText(error_number) + ")";
}

}  // namespace

std::string SystemText(int error_number) { return std::generic_category().message(error_number); }

Error SystemError(const std::filesystem::path& path, const std::string& what, int error_number) {
  return {path.string(), Finding(what, error_number), Remedy(error_number)};
}

Error ReadError(const std::filesystem::path& path, int error_number) {
  return {path.string(), Finding("cannot be read", error_number), ReadRemedy(error_number)};
}

}  // namespace colmap_seapoint
