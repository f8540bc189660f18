#include "colmap_seapoint/base/version.h"

namespace colmap_seapoint {

std::string Version() { return SEAPOINT_VERSION; }

}  // namespace colmap_seapoint
