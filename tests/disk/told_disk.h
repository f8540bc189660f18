// A disk whose free bytes a test tells.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/cli/cli_runner.h"

namespace colmap_seapoint {

class ToldDisk {
 public:
  explicit ToldDisk(const std::filesystem::path& folder) : file_(folder / "free_bytes") {
    setenv("SEAPOINT_FREE_DISK", file_.c_str(), 1);
  }
  ~ToldDisk() { unsetenv("SEAPOINT_FREE_DISK"); }
  ToldDisk(const ToldDisk&) = delete;
  ToldDisk& operator=(const ToldDisk&) = delete;

  // Whole at any moment, for who reads it meanwhile.
  void SetFree(uint64_t bytes) const {
    WriteBytes(file_.string() + ".new", std::to_string(bytes) + "\n");
    std::filesystem::rename(file_.string() + ".new", file_);
  }

 private:
  std::filesystem::path file_;
};

}  // namespace colmap_seapoint
