#include "colmap_seapoint/io/las/laz_file.h"

#include <laszip/laszip_api.h>

#include <cstring>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/io/files/atomic_path.h"
#include "colmap_seapoint/io/las/export_cloud.h"

namespace colmap_seapoint {

bool CanWriteLaz() { return true; }

struct LazFile::Impl {
  Impl(const std::filesystem::path& path, const LasHeader& header_in)
      : file(path), header(header_in) {
    Check(laszip_create(&laszip));
    Check(laszip_preserve_generating_software(laszip, 1));
    DescribeHeader();
    for (const LasRecord& record : RecordsOf(header)) {
      Check(laszip_add_vlr(laszip, record.user.c_str(), record.id,
                           static_cast<laszip_U16>(record.bytes.size()), record.description.c_str(),
                           reinterpret_cast<const laszip_U8*>(record.bytes.data())));
    }
    Check(laszip_open_writer(laszip, file.Temporary().c_str(), 1));
    Check(laszip_get_point_pointer(laszip, &point));
  }
  ~Impl() {
    if (laszip != nullptr) laszip_destroy(laszip);
  }

  void DescribeHeader() {
    laszip_header_struct* out = nullptr;
    Check(laszip_get_header_pointer(laszip, &out));
    out->global_encoding = 1 << 4;
    out->version_major = 1;
    out->version_minor = 4;
    std::strncpy(out->system_identifier, kLasWords, sizeof(out->system_identifier));
    const std::string software = "colmap_seapoint " + std::string(Version());
    std::strncpy(out->generating_software, software.c_str(), sizeof(out->generating_software) - 1);
    out->header_size = kLasHeaderBytes;
    out->offset_to_point_data = kLasHeaderBytes;
    out->point_data_format = 7;
    out->point_data_record_length = static_cast<laszip_U16>(kLasPointBytes + ExtraBytes(header));
    out->x_scale_factor = out->y_scale_factor = out->z_scale_factor = header.scale;
    out->x_offset = header.offset.x();
    out->y_offset = header.offset.y();
    out->z_offset = header.offset.z();
    out->min_x = header.min.x();
    out->min_y = header.min.y();
    out->min_z = header.min.z();
    out->max_x = header.max.x();
    out->max_y = header.max.y();
    out->max_z = header.max.z();
    out->extended_number_of_point_records = header.num_points;
    out->extended_number_of_points_by_return[0] = header.num_points;
  }

  void Check(laszip_I32 failed) const {
    if (failed == 0) return;
    laszip_CHAR* message = nullptr;
    if (laszip != nullptr) laszip_get_error(laszip, &message);
    throw Error(
        file.Path().string(),
        "cannot be written (LASzip: " + std::string(message ? message : "cannot start") + ")",
        "free some space, or choose a folder on another disk");
  }

  AtomicPath file;
  LasHeader header;
  laszip_POINTER laszip = nullptr;
  laszip_point_struct* point = nullptr;
  std::vector<char> extra;
};

LazFile::LazFile(const std::filesystem::path& path, const LasHeader& header)
    : impl_(std::make_unique<Impl>(path, header)) {}

LazFile::~LazFile() = default;

void LazFile::Add(const CloudVertex& vertex, const Eigen::Vector3d& xyz) {
  laszip_point_struct* point = impl_->point;
  const std::array<int32_t, 3> integers = Quantized(impl_->header, xyz);
  point->X = integers[0];
  point->Y = integers[1];
  point->Z = integers[2];
  point->return_number = point->number_of_returns = 1;
  point->extended_point_type = 1;
  point->extended_return_number = point->extended_number_of_returns = 1;
  const std::array<uint16_t, 3> color = WideColor(vertex.rgb);
  std::copy(color.begin(), color.end(), point->rgb);
  impl_->extra.clear();
  AppendExtraBytes(impl_->header, vertex, &impl_->extra);
  SEAPOINT_CHECK(point->num_extra_bytes == static_cast<laszip_I32>(impl_->extra.size()));
  if (!impl_->extra.empty()) {
    std::memcpy(point->extra_bytes, impl_->extra.data(), impl_->extra.size());
  }
  impl_->Check(laszip_write_point(impl_->laszip));
}

void LazFile::Finish() {
  impl_->Check(laszip_close_writer(impl_->laszip));
  impl_->file.Commit();
}

}  // namespace colmap_seapoint
