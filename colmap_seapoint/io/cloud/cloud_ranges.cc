#include "colmap_seapoint/io/cloud/cloud_ranges.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply_header.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/io/files/input_stream.h"
#include "colmap_seapoint/system/system_error.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kPointBytes = 7 * sizeof(float) + 3;  // as CloudWriter writes them

}  // namespace

CloudRanges::CloudRanges(const std::filesystem::path& path) : path_(path) {
  {
    InputStream stream(path);
    const PlyHeader header = ReadPlyHeader(path.string(), &stream);
    first_byte_ = static_cast<uint64_t>(stream.tellg());
    const bool is_ours = !header.is_ascii && !header.is_big_endian && header.elements.size() == 1 &&
                         header.elements[0].properties.size() == 10 &&
                         header.elements[0].MinRowBytes() == kPointBytes;
    if (is_ours) num_points_ = header.elements[0].count;
    if (!is_ours || std::filesystem::file_size(path) != first_byte_ + num_points_ * kPointBytes) {
      throw Error(path.string(), "is no cloud of this program", "let it be written again");
    }
  }
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) throw ReadError(path, errno);
}

CloudRanges::~CloudRanges() { close(descriptor_); }

std::vector<char> CloudRanges::ReadBytes(uint64_t first, uint64_t count) const {
  SEAPOINT_CHECK(count <= num_points_ && first <= num_points_ - count);
  std::vector<char> bytes(count * kPointBytes);
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = pread(descriptor_, bytes.data() + done, bytes.size() - done,
                              static_cast<off_t>(first_byte_ + first * kPointBytes + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw ReadError(path_, errno);
    if (got == 0) throw Error(path_.string(), "has become shorter", "let it be written again");
    done += static_cast<size_t>(got);
  }
  return bytes;
}

std::string CloudRanges::HashOfFirst(uint64_t count) const {
  constexpr uint64_t kAtOnce = 1 << 15;
  ContentHash hash;
  for (uint64_t first = 0; first < count; first += kAtOnce) {
    const std::vector<char> bytes = ReadBytes(first, std::min(kAtOnce, count - first));
    hash.Add(bytes.data(), bytes.size());
  }
  return hash.Text();
}

std::vector<CloudPoint> CloudRanges::Read(uint64_t first, uint64_t count) const {
  const std::vector<char> bytes = ReadBytes(first, count);
  std::vector<CloudPoint> points(count);
  for (size_t i = 0; i < count; ++i) {
    const char* record = bytes.data() + i * kPointBytes;
    std::memcpy(points[i].xyz.data(), record, 3 * sizeof(float));
    std::memcpy(points[i].normal.data(), record + 3 * sizeof(float), 3 * sizeof(float));
    std::memcpy(points[i].rgb.data(), record + 6 * sizeof(float), 3);
    std::memcpy(&points[i].confidence, record + 6 * sizeof(float) + 3, sizeof(float));
  }
  return points;
}

}  // namespace colmap_seapoint
