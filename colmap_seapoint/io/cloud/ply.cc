#include "colmap_seapoint/io/cloud/ply.h"

#include <cmath>
#include <cstring>
#include <string>

#include "colmap_seapoint/io/cloud/ply_reader.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the files are little-endian");

constexpr size_t kPointBytes = 7 * sizeof(float) + 3;
constexpr size_t kWriteBytes = 1 << 18;

// The number of vertices is known at the end only. A comment of dots takes up what a shorter number
// leaves, so that the number itself is written as every program expects it.
std::string CloudHeader(uint64_t num_points) {
  const std::string count = std::to_string(num_points);
  return "ply\nformat binary_little_endian 1.0\ncomment colmap_seapoint " +
         std::string(21 - count.size(), '.') + "\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\n"
         "property float nx\nproperty float ny\nproperty float nz\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\n"
         "property float confidence\nend_header\n";
}

std::string VisPath(const std::filesystem::path& path) { return path.string() + ".vis"; }

}  // namespace

CloudWriter::CloudWriter(const std::filesystem::path& path)
    : ply_(std::make_unique<AtomicFile>(path)), vis_(std::make_unique<AtomicFile>(VisPath(path))) {
  ply_->Write(CloudHeader(0));
  vis_->Write(&num_points_, sizeof(num_points_));
}

CloudWriter::~CloudWriter() = default;

void CloudWriter::Add(const CloudPoint& point, const uint32_t* image_idxs,
                      uint32_t num_image_idxs) {
  if (!point.xyz.allFinite() || !point.normal.allFinite() || !std::isfinite(point.confidence)) {
    ++num_skipped_;
    return;
  }
  const size_t at = ply_buffer_.size(), vis_at = vis_buffer_.size();
  ply_buffer_.resize(at + kPointBytes);
  char* record = ply_buffer_.data() + at;
  std::memcpy(record, point.xyz.data(), 3 * sizeof(float));
  std::memcpy(record + 3 * sizeof(float), point.normal.data(), 3 * sizeof(float));
  std::memcpy(record + 6 * sizeof(float), point.rgb.data(), 3);
  std::memcpy(record + 6 * sizeof(float) + 3, &point.confidence, sizeof(float));
  vis_buffer_.resize(vis_at + (1 + num_image_idxs) * sizeof(uint32_t));
  std::memcpy(vis_buffer_.data() + vis_at, &num_image_idxs, sizeof(uint32_t));
  if (num_image_idxs > 0) {  // a null pointer may not be copied from, not even zero bytes
    std::memcpy(vis_buffer_.data() + vis_at + sizeof(uint32_t), image_idxs,
                num_image_idxs * sizeof(uint32_t));
  }
  ++num_points_;
  if (ply_buffer_.size() >= kWriteBytes) Flush();
}

void CloudWriter::Flush() {
  ply_->Write(ply_buffer_.data(), ply_buffer_.size());
  vis_->Write(vis_buffer_.data(), vis_buffer_.size());
  ply_buffer_.clear();
  vis_buffer_.clear();
}

void CloudWriter::Finish() {
  Flush();
  const std::string header = CloudHeader(num_points_);
  ply_->WriteAt(0, header.data(), header.size());
  vis_->WriteAt(0, &num_points_, sizeof(num_points_));
  vis_->Commit();
  ply_->Commit();
}

std::vector<CloudPoint> ReadCloud(const std::filesystem::path& path) {
  CloudReader reader(path);
  std::vector<CloudPoint> points;
  points.reserve(reader.NumPoints());
  for (CloudVertex vertex; reader.Next(&vertex);) {
    points.push_back({vertex.xyz.cast<float>(), vertex.normal, vertex.rgb, vertex.confidence});
  }
  return points;
}

}  // namespace colmap_seapoint
