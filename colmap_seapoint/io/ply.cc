#include "colmap_seapoint/io/ply.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/ply_header.h"

namespace colmap_seapoint {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the files are little-endian");

constexpr size_t kPointBytes = 6 * sizeof(float) + 3;
constexpr size_t kReadBytes = 1 << 20;
constexpr size_t kWriteBytes = 1 << 18;
constexpr const char* kRemedy = "restore a copy, or save the cloud again";

// The number of vertices is known at the end only. A comment of dots takes up what a shorter number
// leaves, so that the number itself is written as every program expects it.
std::string CloudHeader(uint64_t num_points) {
  const std::string count = std::to_string(num_points);
  return "ply\nformat binary_little_endian 1.0\ncomment colmap_seapoint " +
         std::string(21 - count.size(), '.') + "\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\n"
         "property float nx\nproperty float ny\nproperty float nz\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
}

std::string VisPath(const std::filesystem::path& path) { return path.string() + ".vis"; }

// Which property of the vertices is which value of a CloudPoint; -1 when it is not there.
struct VertexLayout {
  int xyz[3];
  int normal[3];
  int rgb[3];
};

VertexLayout FindVertexLayout(const std::string& path, const PlyElement& vertex) {
  VertexLayout layout;
  const char* const kXyz[] = {"x", "y", "z"};
  const char* const kNormal[] = {"nx", "ny", "nz"};
  const char* const kRgb[] = {"red", "green", "blue"};
  const char* const kShort[] = {"r", "g", "b"};
  for (int i = 0; i < 3; ++i) {
    layout.xyz[i] = vertex.Find(kXyz[i]);
    layout.normal[i] = vertex.Find(kNormal[i]);
    layout.rgb[i] = vertex.Find(kRgb[i]);
    if (layout.rgb[i] < 0) layout.rgb[i] = vertex.Find(std::string("diffuse_") + kRgb[i]);
    if (layout.rgb[i] < 0) layout.rgb[i] = vertex.Find(kShort[i]);
    if (layout.xyz[i] < 0) {
      throw Error(path, std::string("its vertices have no property ") + kXyz[i], kRemedy);
    }
  }
  return layout;
}

uint8_t ColorByte(double value, PlyType type) {
  if (type == PlyType::kFloat32 || type == PlyType::kFloat64) value *= 255.0;
  if (type == PlyType::kUInt16) value /= 257.0;
  if (!(value > 0)) return 0;
  return value >= 255 ? 255 : static_cast<uint8_t>(std::lround(value));
}

// `values`: one for each property of `vertex`.
CloudPoint MakePoint(const PlyElement& vertex, const VertexLayout& layout,
                     const std::vector<double>& values) {
  CloudPoint point;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<size_t>(i);
    point.xyz[i] = static_cast<float>(values[static_cast<size_t>(layout.xyz[i])]);
    if (layout.normal[i] >= 0) {
      point.normal[i] = static_cast<float>(values[static_cast<size_t>(layout.normal[i])]);
    }
    if (layout.rgb[i] >= 0) {
      const auto property = static_cast<size_t>(layout.rgb[i]);
      point.rgb[k] = ColorByte(values[property], vertex.properties[property].type);
    }
  }
  return point;
}

template <typename T>
double Load(const char* data) {
  T value;
  std::memcpy(&value, data, sizeof(T));
  return static_cast<double>(value);
}

double LoadValue(const char* data, PlyType type) {
  switch (type) {
    case PlyType::kInt8:
      return Load<int8_t>(data);
    case PlyType::kUInt8:
      return Load<uint8_t>(data);
    case PlyType::kInt16:
      return Load<int16_t>(data);
    case PlyType::kUInt16:
      return Load<uint16_t>(data);
    case PlyType::kInt32:
      return Load<int32_t>(data);
    case PlyType::kUInt32:
      return Load<uint32_t>(data);
    case PlyType::kFloat32:
      return Load<float>(data);
    case PlyType::kFloat64:
      return Load<double>(data);
  }
  return 0;
}

// Reads the rows of elements, value by value, from either form.
class RowReader {
 public:
  RowReader(const std::string& path, std::ifstream* stream, bool is_ascii)
      : path_(path), stream_(*stream), is_ascii_(is_ascii), buffer_(kReadBytes) {
    std::error_code error;
    const uint64_t size = std::filesystem::file_size(path, error);
    remaining_ = error ? 0 : size - static_cast<uint64_t>(stream_.tellg());
  }

  // A corrupt count must not make anyone reserve gigabytes.
  void CheckCount(const PlyElement& element) const {
    // The last value of an ASCII file needs no line end.
    const uint64_t min_bytes =
        is_ascii_ ? 2 * element.properties.size() : std::max<uint64_t>(1, element.MinRowBytes());
    if (min_bytes > 0 && element.count > (remaining_ + 1) / min_bytes) {
      throw Error(path_,
                  "is truncated: its header announces " + std::to_string(element.count) + " of '" +
                      element.name + "', more than the file holds",
                  kRemedy);
    }
  }

  void ReadRow(const PlyElement& element, std::vector<double>* values) {
    values->resize(element.properties.size());
    for (size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (!property.is_list) {
        (*values)[i] = ReadValue(property.type);
        continue;
      }
      const double count = ReadValue(property.count_type);
      for (double k = 0; k < count; ++k) ReadValue(property.type);
      (*values)[i] = count;
    }
  }

 private:
  double ReadValue(PlyType type) {
    if (is_ascii_) return ReadAsciiValue();
    const size_t size = PlyTypeBytes(type);
    if (end_ - begin_ < size) Refill(size);
    const double value = LoadValue(buffer_.data() + begin_, type);
    begin_ += size;
    return value;
  }

  double ReadAsciiValue() {
    if (!(stream_ >> word_)) Truncated();
    char* end = nullptr;
    const double value = std::strtod(word_.c_str(), &end);
    if (*end != '\0') {
      throw Error(path_, "'" + word_.substr(0, 40) + "' is no number", kRemedy);
    }
    return value;
  }

  void Refill(size_t needed) {
    const size_t left = end_ - begin_;
    std::memmove(buffer_.data(), buffer_.data() + begin_, left);
    stream_.read(buffer_.data() + left, static_cast<std::streamsize>(buffer_.size() - left));
    begin_ = 0;
    end_ = left + static_cast<size_t>(stream_.gcount());
    if (end_ < needed) Truncated();
  }

  [[noreturn]] void Truncated() const {
    throw Error(path_, "is truncated: it ends in the middle of the points", kRemedy);
  }

  const std::string& path_;
  std::ifstream& stream_;
  bool is_ascii_;
  std::string word_;
  std::vector<char> buffer_;
  size_t begin_ = 0, end_ = 0;
  uint64_t remaining_ = 0;
};

}  // namespace

CloudWriter::CloudWriter(const std::filesystem::path& path) : ply_(path), vis_(VisPath(path)) {
  ply_.Write(CloudHeader(0));
  vis_.Write(&num_points_, sizeof(num_points_));
}

CloudWriter::~CloudWriter() = default;

void CloudWriter::Add(const CloudPoint& point, const uint32_t* image_idxs,
                      uint32_t num_image_idxs) {
  if (!point.xyz.allFinite() || !point.normal.allFinite()) {
    ++num_skipped_;
    return;
  }
  const size_t at = ply_buffer_.size(), vis_at = vis_buffer_.size();
  ply_buffer_.resize(at + kPointBytes);
  char* record = ply_buffer_.data() + at;
  std::memcpy(record, point.xyz.data(), 3 * sizeof(float));
  std::memcpy(record + 3 * sizeof(float), point.normal.data(), 3 * sizeof(float));
  std::memcpy(record + 6 * sizeof(float), point.rgb.data(), 3);
  vis_buffer_.resize(vis_at + (1 + num_image_idxs) * sizeof(uint32_t));
  std::memcpy(vis_buffer_.data() + vis_at, &num_image_idxs, sizeof(uint32_t));
  std::memcpy(vis_buffer_.data() + vis_at + sizeof(uint32_t), image_idxs,
              num_image_idxs * sizeof(uint32_t));
  ++num_points_;
  if (ply_buffer_.size() >= kWriteBytes) Flush();
}

void CloudWriter::Flush() {
  ply_.Write(ply_buffer_.data(), ply_buffer_.size());
  vis_.Write(vis_buffer_.data(), vis_buffer_.size());
  ply_buffer_.clear();
  vis_buffer_.clear();
}

void CloudWriter::Finish() {
  Flush();
  const std::string header = CloudHeader(num_points_);
  ply_.WriteAt(0, header.data(), header.size());
  vis_.WriteAt(0, &num_points_, sizeof(num_points_));
  vis_.Commit();
  ply_.Commit();
}

std::vector<CloudPoint> ReadCloud(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::error_code ignored;
  std::ifstream stream(path, std::ios::binary);
  if (!stream || !std::filesystem::is_regular_file(path, ignored)) {
    throw Error(name, "cannot be read", "check the path and the file's permissions");
  }
  const PlyHeader header = ReadPlyHeader(name, &stream);
  RowReader rows(name, &stream, header.is_ascii);
  std::vector<double> values;
  for (const PlyElement& element : header.elements) {
    rows.CheckCount(element);
    if (element.name != "vertex") {
      if (!element.properties.empty()) {
        for (uint64_t i = 0; i < element.count; ++i) rows.ReadRow(element, &values);
      }
      continue;
    }
    const VertexLayout layout = FindVertexLayout(name, element);
    std::vector<CloudPoint> points;
    points.reserve(element.count);
    for (uint64_t i = 0; i < element.count; ++i) {
      rows.ReadRow(element, &values);
      points.push_back(MakePoint(element, layout, values));
      if (!points.back().xyz.allFinite()) {
        throw Error(name, "vertex " + std::to_string(i) + " is not finite",
                    "remove such points, e.g. in CloudCompare or MeshLab");
      }
    }
    return points;
  }
  throw Error(name, "the PLY header names no element 'vertex'", "give a point cloud");
}

}  // namespace colmap_seapoint
