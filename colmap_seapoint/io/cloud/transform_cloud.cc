#include "colmap_seapoint/io/cloud/transform_cloud.h"

#include <charconv>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply_header.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kBufferBytes = 1 << 20;
constexpr char kRemedy[] = "restore a copy, or save the cloud again";

// Where in a vertex its position and normal are; -1: it has none.
struct Places {
  int xyz[3];
  int normal[3];
  bool has_normal = false;
};

Places FindPlaces(const std::string& path, const PlyElement& vertex) {
  const char* const kXyz[] = {"x", "y", "z"};
  const char* const kNormal[] = {"nx", "ny", "nz"};
  Places places;
  places.has_normal = true;
  for (int i = 0; i < 3; ++i) {
    places.xyz[i] = vertex.Find(kXyz[i]);
    places.normal[i] = vertex.Find(kNormal[i]);
    places.has_normal = places.has_normal && places.normal[i] >= 0;
    if (places.xyz[i] < 0) {
      throw Error(path, std::string("its vertices have no property ") + kXyz[i], kRemedy);
    }
  }
  const auto check = [&](const int* indices) {
    for (int i = 0; i < 3; ++i) {
      const PlyType type = vertex.properties[static_cast<size_t>(indices[i])].type;
      if (type == PlyType::kFloat32 || type == PlyType::kFloat64) continue;
      throw Error(path, "positions or normals of its vertices are neither float nor double",
                  "save the cloud with float or double positions");
    }
  };
  check(places.xyz);
  if (places.has_normal) check(places.normal);
  return places;
}

// Byte offsets of the properties in a row.
std::vector<size_t> Offsets(const PlyElement& vertex) {
  std::vector<size_t> offsets = {0};
  for (const PlyProperty& property : vertex.properties) {
    offsets.push_back(offsets.back() + PlyTypeBytes(property.type));
  }
  return offsets;
}

Eigen::Vector3d NewNormal(const Eigen::Vector3d& normal, const Similarity3d& new_from_old) {
  const double length = normal.norm();
  if (!(length > 0)) return normal;  // none
  return new_from_old.rotation * (normal / length);
}

class Job {
 public:
  Job(const std::filesystem::path& from, const std::filesystem::path& to,
      const Similarity3d& new_from_old)
      : path_(from.string()), stream_(from), similarity_(new_from_old) {
    header_ = ReadPlyHeader(path_, &stream_);
    if (header_.is_big_endian) {
      throw Error(path_, "is big-endian", "save the cloud as binary_little_endian or ASCII");
    }
    if (header_.elements.empty() || header_.elements[0].name != "vertex" ||
        header_.elements[0].HasLists()) {
      throw Error(path_, "its first element is not 'vertex' without lists",
                  "save the cloud again with CloudCompare or MeshLab");
    }
    places_ = FindPlaces(path_, header_.elements[0]);
    output_.emplace(to);
  }

  uint64_t Run() {
    const auto header_bytes = static_cast<size_t>(stream_.tellg());
    std::string header(header_bytes, '\0');
    stream_.seekg(0);
    stream_.read(header.data(), static_cast<std::streamsize>(header_bytes));
    output_->Write(header);
    const uint64_t count = header_.elements[0].count;
    header_.is_ascii ? MoveLines(count) : MoveRows(count);
    output_->WriteRest(&stream_);
    return count;
  }
  void Commit() { output_->Commit(); }

 private:
  [[noreturn]] void Truncated() const {
    throw Error(path_, "is truncated: it ends in the middle of the points", kRemedy);
  }

  void MoveRows(uint64_t count) {
    const PlyElement& vertex = header_.elements[0];
    const std::vector<size_t> offsets = Offsets(vertex);
    const size_t row_bytes = offsets.back();
    std::vector<char> buffer(std::max(row_bytes, kBufferBytes / row_bytes * row_bytes));
    while (count > 0) {
      const uint64_t rows = std::min<uint64_t>(count, buffer.size() / row_bytes);
      const size_t bytes = static_cast<size_t>(rows) * row_bytes;
      stream_.read(buffer.data(), static_cast<std::streamsize>(bytes));
      if (static_cast<size_t>(stream_.gcount()) != bytes) Truncated();
      for (size_t at = 0; at < bytes; at += row_bytes) {
        char* row = buffer.data() + at;
        Put(vertex, offsets, places_.xyz, Moved(Get(vertex, offsets, places_.xyz, row)), row);
        if (!places_.has_normal) continue;
        const Eigen::Vector3d normal = Get(vertex, offsets, places_.normal, row);
        Put(vertex, offsets, places_.normal, NewNormal(normal, similarity_), row);
      }
      output_->Write(buffer.data(), bytes);
      count -= rows;
    }
  }

  // What is written can be read again.
  Eigen::Vector3d Moved(const Eigen::Vector3d& xyz) const {
    const Eigen::Vector3d moved = similarity_ * xyz;
    if ((moved.array().abs() <= kMaxCoordinate).all()) return moved;
    throw Error(path_, "a point lies farther than 1e15 from the origin, or is not finite",
                "remove such points, e.g. in CloudCompare or MeshLab");
  }

  static Eigen::Vector3d Get(const PlyElement& vertex, const std::vector<size_t>& offsets,
                             const int* places, const char* row) {
    Eigen::Vector3d result;
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<size_t>(places[i]);
      if (vertex.properties[k].type == PlyType::kFloat64) {
        std::memcpy(&result[i], row + offsets[k], sizeof(double));
      } else {
        float value;
        std::memcpy(&value, row + offsets[k], sizeof(float));
        result[i] = static_cast<double>(value);
      }
    }
    return result;
  }

  static void Put(const PlyElement& vertex, const std::vector<size_t>& offsets, const int* places,
                  const Eigen::Vector3d& value, char* row) {
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<size_t>(places[i]);
      if (vertex.properties[k].type == PlyType::kFloat64) {
        std::memcpy(row + offsets[k], &value[i], sizeof(double));
      } else {
        const auto narrow = static_cast<float>(value[i]);
        std::memcpy(row + offsets[k], &narrow, sizeof(float));
      }
    }
  }

  void MoveLines(uint64_t count) {
    std::string line, text;
    while (count > 0) {
      if (!std::getline(stream_, line)) Truncated();
      std::istringstream words(line);
      std::vector<std::string> fields;
      for (std::string word; words >> word;) fields.push_back(word);
      if (fields.empty()) continue;
      if (fields.size() < header_.elements[0].properties.size()) Truncated();
      Replace(places_.xyz, Moved(Parse(places_.xyz, fields)), &fields);
      if (places_.has_normal) {
        Replace(places_.normal, NewNormal(Parse(places_.normal, fields), similarity_), &fields);
      }
      for (const std::string& field : fields) text += (&field == &fields[0] ? "" : " ") + field;
      text += "\n";
      if (text.size() > kBufferBytes) {
        output_->Write(text);
        text.clear();
      }
      --count;
    }
    output_->Write(text);
  }

  Eigen::Vector3d Parse(const int* places, const std::vector<std::string>& fields) const {
    Eigen::Vector3d result;
    for (int i = 0; i < 3; ++i) {
      const std::string& field = fields[static_cast<size_t>(places[i])];
      const auto parsed = std::from_chars(field.data(), field.data() + field.size(), result[i]);
      if (parsed.ec != std::errc() || parsed.ptr != field.data() + field.size()) {
        throw Error(path_, "'" + field.substr(0, 40) + "' is no number", kRemedy);
      }
    }
    return result;
  }

  static void Replace(const int* places, const Eigen::Vector3d& value,
                      std::vector<std::string>* fields) {
    for (int i = 0; i < 3; ++i) {
      char buffer[40];
      const auto end =
          std::to_chars(buffer, buffer + sizeof(buffer), value[i], std::chars_format::general, 10);
      (*fields)[static_cast<size_t>(places[i])] = std::string(buffer, end.ptr);
    }
  }

  std::string path_;
  InputStream stream_;
  const Similarity3d& similarity_;
  PlyHeader header_;
  Places places_{};
  std::optional<AtomicFile> output_;
};

}  // namespace

uint64_t TransformCloud(const std::filesystem::path& from, const std::filesystem::path& to,
                        const Similarity3d& new_from_old) {
  Job job(from, to, new_from_old);
  const uint64_t count = job.Run();
  const std::unique_ptr<InputStream> vis = OpenIfThere(from.string() + ".vis");
  if (vis != nullptr) {
    AtomicFile copy(to.string() + ".vis");
    copy.WriteRest(vis.get());
    copy.Commit();
  }
  job.Commit();
  return count;
}

}  // namespace colmap_seapoint
