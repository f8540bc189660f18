#include "colmap_seapoint/io/cloud/ply_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply_header.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kReadBytes = 1 << 20;
constexpr const char* kRemedy = "restore a copy, or save the cloud again";

// Which property of the vertices is which value of a CloudVertex; -1 when it is not there.
struct VertexLayout {
  std::array<int, 3> xyz, normal, rgb;
  int confidence;
};

VertexLayout FindVertexLayout(const std::string& path, const PlyElement& vertex) {
  VertexLayout layout;
  const char* const kXyz[] = {"x", "y", "z"};
  const char* const kNormal[] = {"nx", "ny", "nz"};
  const char* const kRgb[] = {"red", "green", "blue"};
  const char* const kShort[] = {"r", "g", "b"};
  for (size_t i = 0; i < 3; ++i) {
    layout.xyz[i] = vertex.Find(kXyz[i]);
    layout.normal[i] = vertex.Find(kNormal[i]);
    layout.rgb[i] = vertex.Find(kRgb[i]);
    if (layout.rgb[i] < 0) layout.rgb[i] = vertex.Find(std::string("diffuse_") + kRgb[i]);
    if (layout.rgb[i] < 0) layout.rgb[i] = vertex.Find(kShort[i]);
    if (layout.xyz[i] < 0) {
      throw Error(path, std::string("its vertices have no property ") + kXyz[i], kRemedy);
    }
  }
  layout.confidence = vertex.Find("confidence");
  return layout;
}

// Whether the vertices are as CloudWriter writes them.
bool IsOurOwn(const PlyHeader& header, const PlyElement& vertex) {
  constexpr const char* kNames[] = {"x",  "y",   "z",     "nx",   "ny",
                                    "nz", "red", "green", "blue", "confidence"};
  if (header.is_ascii || header.is_big_endian || vertex.properties.size() != 10) return false;
  for (size_t i = 0; i < 10; ++i) {
    const PlyProperty& property = vertex.properties[i];
    const PlyType type = i >= 6 && i < 9 ? PlyType::kUInt8 : PlyType::kFloat32;
    if (property.is_list || property.name != kNames[i] || property.type != type) return false;
  }
  return true;
}

uint8_t ColorByte(double value, PlyType type) {
  if (type == PlyType::kFloat32 || type == PlyType::kFloat64) value *= 255.0;
  if (type == PlyType::kUInt16) value /= 257.0;
  if (!(value > 0)) return 0;
  return value >= 255 ? 255 : static_cast<uint8_t>(std::lround(value));
}

// `values`: one for each property of `vertex`.
void SetVertex(const PlyElement& vertex, const VertexLayout& layout,
               const std::vector<double>& values, CloudVertex* point) {
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<size_t>(i);
    point->xyz[i] = values[static_cast<size_t>(layout.xyz[k])];
    if (layout.normal[k] >= 0) {
      point->normal[i] = static_cast<float>(values[static_cast<size_t>(layout.normal[k])]);
    }
    if (layout.rgb[k] >= 0) {
      const auto property = static_cast<size_t>(layout.rgb[k]);
      point->rgb[k] = ColorByte(values[property], vertex.properties[property].type);
    }
  }
  if (layout.confidence >= 0) {
    point->confidence = static_cast<float>(values[static_cast<size_t>(layout.confidence)]);
  }
}

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "values are turned where files are not");

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
  RowReader(const std::string& path, std::istream* stream, const PlyHeader& header)
      : path_(path),
        stream_(*stream),
        is_ascii_(header.is_ascii),
        is_big_endian_(header.is_big_endian),
        buffer_(kReadBytes) {
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

  // A row that IsOurOwn().
  void ReadOwnRow(CloudVertex* vertex) {
    constexpr size_t kBytes = 7 * sizeof(float) + 3;
    if (end_ - begin_ < kBytes) Refill(kBytes);
    const char* bytes = buffer_.data() + begin_;
    Eigen::Vector3f xyz;
    std::memcpy(xyz.data(), bytes, 3 * sizeof(float));
    std::memcpy(vertex->normal.data(), bytes + 3 * sizeof(float), 3 * sizeof(float));
    std::memcpy(vertex->rgb.data(), bytes + 6 * sizeof(float), 3);
    std::memcpy(&vertex->confidence, bytes + 6 * sizeof(float) + 3, sizeof(float));
    vertex->xyz = xyz.cast<double>();
    begin_ += kBytes;
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
    char* const bytes = buffer_.data() + begin_;
    if (is_big_endian_) std::reverse(bytes, bytes + size);
    const double value = LoadValue(bytes, type);
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
  std::istream& stream_;
  bool is_ascii_;
  bool is_big_endian_;
  std::string word_;
  std::vector<char> buffer_;
  size_t begin_ = 0, end_ = 0;
  uint64_t remaining_ = 0;
};

}  // namespace

struct CloudReader::State {
  explicit State(const std::filesystem::path& file) : path(file.string()), stream(file) {
    header = ReadPlyHeader(path, &stream);
    rows = std::make_unique<RowReader>(path, &stream, header);
    FindVertices();
  }

  void FindVertices() {
    for (const PlyElement& element : header.elements) {
      rows->CheckCount(element);
      if (element.name == "vertex") {
        vertex = &element;
        layout = FindVertexLayout(path, element);
        is_own = IsOurOwn(header, element);
        return;
      }
      if (element.properties.empty()) continue;
      for (uint64_t i = 0; i < element.count; ++i) rows->ReadRow(element, &values);
    }
    throw Error(path, "the PLY header names no element 'vertex'", "give a point cloud");
  }

  std::string path;
  InputStream stream;
  PlyHeader header;
  std::unique_ptr<RowReader> rows;
  const PlyElement* vertex = nullptr;
  VertexLayout layout;
  bool is_own = false;
  std::vector<double> values;
  uint64_t num_read = 0;
};

CloudReader::CloudReader(const std::filesystem::path& path)
    : state_(std::make_unique<State>(path)) {}

CloudReader::~CloudReader() = default;

uint64_t CloudReader::NumPoints() const { return state_->vertex->count; }

bool CloudReader::HasNormals() const {
  const auto& normal = state_->layout.normal;
  return std::all_of(normal.begin(), normal.end(), [](int i) { return i >= 0; });
}

bool CloudReader::HasColors() const {
  const auto& rgb = state_->layout.rgb;
  return std::all_of(rgb.begin(), rgb.end(), [](int i) { return i >= 0; });
}

bool CloudReader::HasConfidence() const { return state_->layout.confidence >= 0; }

bool CloudReader::FitsFloat() const {
  if (state_->header.is_ascii) return false;
  for (const int i : state_->layout.xyz) {
    const PlyType type = state_->vertex->properties[static_cast<size_t>(i)].type;
    if (type == PlyType::kFloat64 || type == PlyType::kInt32 || type == PlyType::kUInt32) {
      return false;
    }
  }
  return true;
}

bool CloudReader::Next(CloudVertex* vertex) {
  State& state = *state_;
  if (state.num_read == state.vertex->count) return false;
  if (state.is_own) {
    state.rows->ReadOwnRow(vertex);
  } else {
    state.rows->ReadRow(*state.vertex, &state.values);
    SetVertex(*state.vertex, state.layout, state.values, vertex);
  }
  if (!vertex->xyz.allFinite()) {
    throw Error(state.path, "vertex " + std::to_string(state.num_read) + " is not finite",
                "remove such points, e.g. in CloudCompare or MeshLab");
  }
  if (vertex->xyz.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    throw Error(state.path,
                "vertex " + std::to_string(state.num_read) +
                    " is too far away: a coordinate is beyond 1e15",
                "remove such points, e.g. in CloudCompare or MeshLab");
  }
  ++state.num_read;
  return true;
}

}  // namespace colmap_seapoint
