// Clouds in COLMAP's own form, binary_little_endian: float x y z nx ny nz, uchar red green blue,
// and our float confidence behind, which COLMAP skips; and
// `<cloud>.vis`: u64 N, N x {u32 k, k x u32 image index}.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

namespace colmap_seapoint {

class AtomicFile;

struct CloudPoint {
  Eigen::Vector3f xyz = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  std::array<uint8_t, 3> rgb = {0, 0, 0};
  float confidence = 1;  // 0..1; 1 where the file has none
};

// Streams points to `path` and `path`.vis; memory does not grow with the cloud. Nothing appears
// under the final names before Finish(); a writer destroyed earlier leaves no file behind. Throws
// Error when a file cannot be created or written.
class CloudWriter {
 public:
  explicit CloudWriter(const std::filesystem::path& path);
  ~CloudWriter();
  // Skips (and counts) points that are not finite. `image_idxs`: positions in images.bin order.
  void Add(const CloudPoint& point, const uint32_t* image_idxs, uint32_t num_image_idxs);
  void Finish();
  uint64_t NumPoints() const { return num_points_; }
  uint64_t NumSkipped() const { return num_skipped_; }

 private:
  void Flush();

  std::unique_ptr<AtomicFile> ply_;
  std::unique_ptr<AtomicFile> vis_;
  std::vector<char> ply_buffer_, vis_buffer_;
  uint64_t num_points_ = 0;
  uint64_t num_skipped_ = 0;
};

// All vertices of any PLY that CloudReader reads (ply_reader.h), positions as float. Throws Error
// as it does.
std::vector<CloudPoint> ReadCloud(const std::filesystem::path& path);

}  // namespace colmap_seapoint
