#include "colmap_seapoint/system/failure_line.h"

#include <filesystem>
#include <new>
#include <opencv2/core.hpp>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/hold/work_pause.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr char kNoMemory[] =
    "memory: not enough for this run; close other programs, use fewer --num_threads or smaller "
    "pictures, and run the same command again: what is done is kept";

bool IsOutOfMemory(const std::exception& error) {
  const auto* of_opencv = dynamic_cast<const cv::Exception*>(&error);
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
         (of_opencv != nullptr && of_opencv->code == cv::Error::StsNoMem);
}

}  // namespace

std::string FailureLine(const std::exception& error) {
  if (dynamic_cast<const Error*>(&error) != nullptr ||
      dynamic_cast<const UsageError*>(&error) != nullptr ||
      dynamic_cast<const WorkStopped*>(&error) != nullptr) {
    return error.what();
  }
  if (IsOutOfMemory(error)) return kNoMemory;
  if (const auto* files = dynamic_cast<const std::filesystem::filesystem_error*>(&error)) {
    const std::filesystem::path& path = files->path2().empty() ? files->path1() : files->path2();
    return SystemError(path, "the system refuses it", files->code().value()).what();
  }
  if (const auto* system = dynamic_cast<const std::system_error*>(&error)) {
    // std::thread and std::mutex throw these; whoever opens files throws Error.
    return SystemError("threads", "the system refuses one", system->code().value()).what();
  }
  return std::string("internal: ") + error.what() + "; please report this";
}

}  // namespace colmap_seapoint
