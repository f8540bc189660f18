// Any part of a cloud on disk, without reading the rest: a survey's cloud need not fit into memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap_seapoint/io/cloud/ply.h"

namespace colmap_seapoint {

class CloudRanges {
 public:
  // A cloud that CloudWriter wrote. Throws Error for any other file.
  explicit CloudRanges(const std::filesystem::path& path);
  ~CloudRanges();
  CloudRanges(const CloudRanges&) = delete;
  CloudRanges& operator=(const CloudRanges&) = delete;

  uint64_t NumPoints() const { return num_points_; }
  // Points first .. first + count - 1, which must exist. From any thread. Throws Error.
  std::vector<CloudPoint> Read(uint64_t first, uint64_t count) const;
  // Of the bytes of the first points, of which there must be so many (content_hash.h).
  std::string HashOfFirst(uint64_t count) const;

 private:
  std::vector<char> ReadBytes(uint64_t first, uint64_t count) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  uint64_t num_points_ = 0;
  uint64_t first_byte_ = 0;
};

}  // namespace colmap_seapoint
