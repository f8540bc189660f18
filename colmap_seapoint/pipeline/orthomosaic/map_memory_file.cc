#include "colmap_seapoint/pipeline/orthomosaic/map_memory_file.h"

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

constexpr char kKind[] = "seapoint map 1";
constexpr uint64_t kMaxItems = uint64_t{1} << 36;

class Writer {
 public:
  explicit Writer(const std::filesystem::path& path) : file_(path) {}
  template <typename T>
  void operator()(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    file_.Write(&value, sizeof(T));
  }
  template <int kRows>
  void operator()(const Eigen::Matrix<double, kRows, 1>& vector) {
    file_.Write(vector.data(), kRows * sizeof(double));
  }
  template <typename T>
  void operator()(const std::vector<T>& values) {
    (*this)(uint64_t{values.size()});
    file_.Write(values.data(), values.size() * sizeof(T));
  }
  void operator()(const std::string& text) {
    (*this)(uint64_t{text.size()});
    file_.Write(text);
  }
  void Finish() { file_.Commit(); }

 private:
  AtomicFile file_;
};

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path), in_(path) {}
  template <typename T>
  void operator()(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    Read(&value, sizeof(T));
  }
  template <int kRows>
  void operator()(Eigen::Matrix<double, kRows, 1>& vector) {
    Read(vector.data(), kRows * sizeof(double));
  }
  template <typename T>
  void operator()(std::vector<T>& values) {
    values.resize(ReadCount());
    Read(values.data(), values.size() * sizeof(T));
  }
  void operator()(std::string& text) {
    text.resize(ReadCount());
    Read(text.data(), text.size());
  }
  [[noreturn]] void Fail() const {
    throw Error(path_.string(), "is no memory of a map", "remove it: the map is made anew");
  }

 private:
  uint64_t ReadCount() {
    uint64_t count = 0;
    (*this)(count);
    if (count > kMaxItems) Fail();
    return count;
  }
  void Read(void* data, size_t size) {
    if (!in_.read(static_cast<char*>(data), static_cast<std::streamsize>(size))) Fail();
  }

  std::filesystem::path path_;
  InputStream in_;
};

// Both ways. Exposure is what it is made of.
template <typename Memory, typename Exposures, typename Visitor>
void Visit(Memory& memory, Exposures& exposure, Visitor& visit) {
  visit(memory.frame.map_from_cloud.rotation.coeffs());
  visit(memory.frame.map_from_cloud.translation);
  visit(memory.frame.kind);
  visit(memory.frame.is_north_up);
  visit(memory.frame.text);
  visit(memory.grid);
  visit(memory.gsd);
  visit(memory.ground);
  visit(memory.cell_size);
  visit(memory.first_pictures);
  visit(memory.num_points);
  visit(memory.mean);
  visit(memory.lowest);
  visit(memory.highest);
  visit(memory.sources.slot);
  visit(memory.sources.sources);
  visit(memory.sources.choice);
  visit(exposure.gains);
  visit(exposure.falloff_of);
  visit(exposure.falloffs);
  visit(exposure.place);
  visit(exposure.mean);
  visit(exposure.along_x);
  visit(exposure.along_y);
}

struct ExposureParts {
  std::vector<Light> gains;
  std::vector<int> falloff_of;
  std::vector<std::array<Light, Exposure::kNumNodes>> falloffs;
  Eigen::Vector2d place;
  Eigen::Vector3d mean, along_x, along_y;
};

}  // namespace

void WriteMapMemory(const std::filesystem::path& path, const MapMemory& memory) {
  const ExposureTrend& trend = memory.exposure.Trend();
  const ExposureParts parts = {memory.exposure.Gains(),
                               memory.exposure.FalloffOf(),
                               memory.exposure.Falloffs(),
                               trend.place,
                               trend.mean,
                               trend.along_x,
                               trend.along_y};
  Writer writer(path);
  writer(std::string(kKind));
  Visit(memory, parts, writer);
  writer.Finish();
}

MapMemory ReadMapMemory(const std::filesystem::path& path) {
  MapMemory memory;
  ExposureParts parts;
  Reader reader(path);
  std::string kind;
  reader(kind);
  if (kind != kKind) reader.Fail();
  Visit(memory, parts, reader);
  memory.exposure =
      Exposure(std::move(parts.gains), std::move(parts.falloff_of), std::move(parts.falloffs),
               {parts.place, parts.mean, parts.along_x, parts.along_y});
  return memory;
}

}  // namespace colmap_seapoint
