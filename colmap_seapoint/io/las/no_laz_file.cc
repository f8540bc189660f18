// In place of laz_file.cc where the build has no LASzip (Debian 12).
#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/las/export_cloud.h"
#include "colmap_seapoint/io/las/laz_file.h"

namespace colmap_seapoint {

bool CanWriteLaz() { return false; }

struct LazFile::Impl {};

LazFile::LazFile(const std::filesystem::path& path, const LasHeader&) {
  throw Error(path.string(), "this build packs no clouds: it was made without liblaszip",
              "give a name that ends in .las, or build on Debian 13 with liblaszip-dev");
}
LazFile::~LazFile() = default;

void LazFile::Add(const CloudVertex&, const Eigen::Vector3d&) {}
void LazFile::Finish() {}

}  // namespace colmap_seapoint
