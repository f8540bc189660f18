// Scratch folders and whole files for the tests of io.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/expect_error.h"

namespace colmap_seapoint {

class TempDir {
 public:
  TempDir() {
    std::string name = (std::filesystem::temp_directory_path() / "seapoint_io_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TempDir() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& Path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string ReadBytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

// Creates its folder.
inline void WriteBytes(const std::filesystem::path& path, const std::string& bytes) {
  std::error_code ignored;  // the stream says it
  std::filesystem::create_directories(path.parent_path(), ignored);
  std::ofstream stream(path, std::ios::binary);
  stream << bytes;
  ASSERT_TRUE(stream.good()) << path;
}

// The folder of real pictures and databases; tests skip when it is absent.
inline std::filesystem::path DataDir() {
  const char* dir = std::getenv("SEAPOINT_DATA");
  return dir != nullptr ? dir : SEAPOINT_DEFAULT_DATA;
}

// Runs COLMAP; its exit code.
inline int RunColmap(const std::string& arguments) {
  const std::string command = "QT_QPA_PLATFORM=offscreen colmap " + arguments + " >/dev/null 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

inline bool HasColmap() { return std::system("command -v colmap >/dev/null 2>&1") == 0; }

}  // namespace colmap_seapoint
