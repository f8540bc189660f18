// The version of the program.
#pragma once

#include <string>

namespace colmap_seapoint {

// Major, minor and patch of this build: "0.2.0".
std::string Version();

}  // namespace colmap_seapoint
