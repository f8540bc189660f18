// A cloud whose points carry a distance, as a number and as a colour: CloudCompare shows both.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {

// Streams a binary little-endian PLY: x y z (float, or double where float would round), red green
// blue, float distance. The number of points is known beforehand. Nothing appears under the final
// name before Finish(). Throws Error when the file cannot be created or written.
class DistanceCloudWriter {
 public:
  // `comment`: one line for the header.
  DistanceCloudWriter(const std::filesystem::path& path, uint64_t num_points, bool as_float,
                      const std::string& comment);
  void Add(const Eigen::Vector3d& xyz, const std::array<uint8_t, 3>& rgb, double distance);
  void Finish();

 private:
  void AddBytes(const void* data, size_t size);
  void Flush();

  AtomicFile file_;
  bool as_float_;
  uint64_t num_left_;
  std::vector<char> buffer_;
};

}  // namespace colmap_seapoint
