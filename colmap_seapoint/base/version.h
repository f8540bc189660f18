#pragma once

#include <string>

namespace colmap_seapoint {

// Of this build, "0.2.0".
std::string Version();

}  // namespace colmap_seapoint
