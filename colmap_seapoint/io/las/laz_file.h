// LAZ by LASzip, where the build has it. For this room only.
#pragma once

#include <filesystem>
#include <memory>

#include "colmap_seapoint/io/las/las_format.h"

namespace colmap_seapoint {

class LazFile {
 public:
  // Throws Error when this build has no LASzip, or the file cannot be written.
  LazFile(const std::filesystem::path& path, const LasHeader& header);
  ~LazFile();
  LazFile(const LazFile&) = delete;
  LazFile& operator=(const LazFile&) = delete;

  void Add(const CloudVertex& vertex, const Eigen::Vector3d& xyz);
  void Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace colmap_seapoint
