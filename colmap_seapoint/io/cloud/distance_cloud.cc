#include "colmap_seapoint/io/cloud/distance_cloud.h"

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kWriteBytes = 1 << 18;

}  // namespace

DistanceCloudWriter::DistanceCloudWriter(const std::filesystem::path& path, uint64_t num_points,
                                         bool as_float, const std::string& comment)
    : file_(path), as_float_(as_float), num_left_(num_points) {
  const std::string type = as_float ? "property float " : "property double ";
  file_.Write("ply\nformat binary_little_endian 1.0\ncomment " + comment + "\nelement vertex " +
              std::to_string(num_points) + "\n" + type + "x\n" + type + "y\n" + type +
              "z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
              "property float distance\nend_header\n");
}

void DistanceCloudWriter::AddBytes(const void* data, size_t size) {
  const char* bytes = static_cast<const char*>(data);
  buffer_.insert(buffer_.end(), bytes, bytes + size);
}

void DistanceCloudWriter::Add(const Eigen::Vector3d& xyz, const std::array<uint8_t, 3>& rgb,
                              double distance) {
  SEAPOINT_CHECK(num_left_ > 0);
  --num_left_;
  if (as_float_) {
    const Eigen::Vector3f rounded = xyz.cast<float>();
    AddBytes(rounded.data(), 3 * sizeof(float));
  } else {
    AddBytes(xyz.data(), 3 * sizeof(double));
  }
  AddBytes(rgb.data(), rgb.size());
  const auto value = static_cast<float>(distance);
  AddBytes(&value, sizeof(value));
  if (buffer_.size() >= kWriteBytes) Flush();
}

void DistanceCloudWriter::Flush() {
  file_.Write(buffer_.data(), buffer_.size());
  buffer_.clear();
}

void DistanceCloudWriter::Finish() {
  SEAPOINT_CHECK(num_left_ == 0);
  Flush();
  file_.Commit();
}

}  // namespace colmap_seapoint
