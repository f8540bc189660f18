#include "colmap_seapoint/system/free_disk.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

TEST(FreeDisk, OfTheNearestFolderThatIsThere) {
  const fs::path folder = fs::temp_directory_path();
  EXPECT_GT(FreeDiskBytes(folder), 0u);
  EXPECT_GT(FreeDiskBytes(folder / "not" / "there" / "yet"), 0u);
}

TEST(FreeDisk, MayBeTold) {
  const fs::path file = fs::temp_directory_path() / "free_disk_test";
  std::ofstream(file) << "12345\n";
  setenv("SEAPOINT_FREE_DISK", file.c_str(), 1);
  EXPECT_EQ(FreeDiskBytes("/"), 12345u);
  fs::remove(file);
  EXPECT_FALSE(FreeDiskBytes("/"));
  unsetenv("SEAPOINT_FREE_DISK");
}

TEST(FreeDisk, KnowsMountPoints) {
  EXPECT_EQ(FileSystemOf("/proc/self/status").mount_point, "/proc");
  EXPECT_EQ(FileSystemOf("/proc/not/there").mount_point, "/proc");
  EXPECT_NE(FileSystemOf("/proc").device, FileSystemOf("/").device);
  EXPECT_EQ(FileSystemOf("/").mount_point, "/");
}

}  // namespace
}  // namespace colmap_seapoint
