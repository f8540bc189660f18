#include "colmap_seapoint/io/las/export_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/cloud/ply_reader.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/map_projection.h"
#include "colmap_seapoint/io/las/las_format.h"
#include "colmap_seapoint/io/las/laz_file.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kBufferBytes = 1 << 20;
constexpr double kFinest = 1e-7;  // of the extent: about the digits of a float

// The smallest power of ten that is not below it.
double PowerOfTenAbove(double value) { return std::pow(10, std::ceil(std::log10(value))); }

// The offset is a round number no farther from the points than ten extents, so that integers stay
// below 2e8.
void ChooseFrame(LasHeader* header) {
  const double extent = (header->max - header->min).maxCoeff();
  const double around = header->max.cwiseAbs().cwiseMax(header->min.cwiseAbs()).maxCoeff();
  // Of a single point, what a double can tell at its place.
  const double size = std::max({extent, around * 1e-9, 1e-9});
  const double step = PowerOfTenAbove(size);
  header->scale = PowerOfTenAbove(size * kFinest);
  header->offset = (header->min / step).array().floor() * step;
}

// What Quantized() makes of a point, as a reader sees it.
Eigen::Vector3d AsRead(const LasHeader& header, const Eigen::Vector3d& xyz) {
  const std::array<int32_t, 3> integers = Quantized(header, xyz);
  return Eigen::Vector3d(integers[0], integers[1], integers[2]) * header.scale + header.offset;
}

LasHeader ReadHeader(const std::filesystem::path& from, const Eigen::Vector3d& shift) {
  CloudReader reader(from);
  LasHeader header;
  header.has_normals = reader.HasNormals();
  header.has_confidence = reader.HasConfidence();
  header.min.setConstant(std::numeric_limits<double>::infinity());
  header.max = -header.min;
  for (CloudVertex vertex; reader.Next(&vertex); ++header.num_points) {
    const Eigen::Vector3d xyz = vertex.xyz + shift;
    header.min = header.min.cwiseMin(xyz);
    header.max = header.max.cwiseMax(xyz);
  }
  if (header.num_points == 0) throw Error(from.string(), "has no points", "give another cloud");
  ChooseFrame(&header);
  header.min = AsRead(header, header.min);
  header.max = AsRead(header, header.max);
  return header;
}

class LasFile {
 public:
  LasFile(const std::filesystem::path& path, const LasHeader& header)
      : file_(path), header_(header), buffer_(HeaderBytes(header)) {}

  void Add(const CloudVertex& vertex, const Eigen::Vector3d& xyz) {
    AppendPoint(header_, vertex, xyz, &buffer_);
    if (buffer_.size() > kBufferBytes) Flush();
  }
  void Finish() {
    Flush();
    file_.Commit();
  }

 private:
  void Flush() {
    file_.Write(buffer_.data(), buffer_.size());
    buffer_.clear();
  }

  AtomicFile file_;
  LasHeader header_;
  std::vector<char> buffer_;
};

template <typename File>
void WritePoints(const std::filesystem::path& from, const LasHeader& header,
                 const Eigen::Vector3d& shift, File file) {
  CloudReader reader(from);
  uint64_t num_points = 0;
  for (CloudVertex vertex; reader.Next(&vertex); ++num_points) file.Add(vertex, vertex.xyz + shift);
  if (num_points != header.num_points) {
    throw Error(from.string(), "has changed while it was read", "run again when it is finished");
  }
  file.Finish();
}

}  // namespace

uint64_t ExportCloud(const std::filesystem::path& from, const std::filesystem::path& to,
                     const CloudExport& options) {
  const bool is_packed = options.packing == LasPacking::kLaz;
  if (is_packed && !CanWriteLaz()) LazFile(to, {});  // says so before the cloud is read
  const std::string wkt = options.crs.empty() ? "" : WellKnownText(options.crs, to.string());
  LasHeader header = ReadHeader(from, options.shift);
  header.crs_wkt = wkt;
  is_packed ? WritePoints<LazFile&&>(from, header, options.shift, LazFile(to, header))
            : WritePoints<LasFile&&>(from, header, options.shift, LasFile(to, header));
  return header.num_points;
}

}  // namespace colmap_seapoint
