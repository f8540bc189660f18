#include "colmap_seapoint/system/failure_line.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <new>
#include <opencv2/core.hpp>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/hold/work_pause.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

std::string LineOf(const std::exception& error) {
  const std::string line = FailureLine(error);
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  return line;
}

TEST(FailureLine, SaysWhatTheSystemSaid) {
  const std::filesystem::filesystem_error disk("cannot create directory", "/a/b",
                                               std::error_code(ENOSPC, std::generic_category()));
  EXPECT_EQ(LineOf(disk),
            "/a/b: the system refuses it (No space left on device); free some space or choose a "
            "folder on another disk");
  const std::filesystem::filesystem_error rename("cannot rename", "/a", "/b",
                                                 std::error_code(EACCES, std::generic_category()));
  EXPECT_EQ(LineOf(rename).find("/b: "), 0u);
  const std::system_error thread(EAGAIN, std::generic_category());
  EXPECT_NE(LineOf(thread).find("ulimit -u"), std::string::npos);
}

TEST(FailureLine, StoppedWorkSaysWhy) {
  EXPECT_EQ(LineOf(WorkStopped("/disk: is full; make room")), "/disk: is full; make room");
}

TEST(FailureLine, MemoryIsNoMistakeOfOurs) {
  const cv::Exception of_opencv(cv::Error::StsNoMem, "Failed to allocate", "f", "f.cpp", 1);
  EXPECT_EQ(LineOf(std::bad_alloc()), LineOf(of_opencv));
  EXPECT_EQ(LineOf(of_opencv).find("memory: "), 0u);
}

TEST(FailureLine, OursAndMistakes) {
  EXPECT_EQ(LineOf(Error("a", "b", "c")), "a: b; c");
  EXPECT_EQ(LineOf(UsageError("d")), "d");
  EXPECT_EQ(LineOf(std::logic_error("e")), "internal: e; please report this");
}

TEST(SystemError, RemediesFollowTheErrorNumber) {
  EXPECT_EQ(std::string(ReadError("f", ENOENT).what()),
            "f: cannot be read (No such file or directory); check the path");
  EXPECT_EQ(std::string(SystemError("f", "cannot be written", EFBIG).what()),
            "f: cannot be written (File too large); free some space or choose a folder on another "
            "disk");
  EXPECT_NE(std::string(ReadError("f", EIO).what()).find("check the disk"), std::string::npos);
  // As a disk that was pulled answers, sooner or later.
  for (const int error_number : {EROFS, ENOMEM}) {
    const std::string line = SystemError("f", "cannot be created", error_number).what();
    EXPECT_NE(line.find("if the disk was pulled"), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace colmap_seapoint
