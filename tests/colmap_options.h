// Options of COLMAP whose names differ between the versions that may be on PATH.
#pragma once

#include <cstdlib>
#include <string>

namespace colmap_seapoint {

// The name of the switch that keeps feature_extractor, or a matcher, off the graphics card: of
// SIFT's group up to 3.12, of the features' group later.
inline std::string GpuOption(const std::string& command) {
  const std::string part = command == "feature_extractor" ? "Extraction" : "Matching";
  const std::string newer = "--Feature" + part + ".use_gpu";
  const std::string ask =
      "QT_QPA_PLATFORM=offscreen colmap " + command + " -h 2>&1 | grep -q -e '" + newer + " '";
  return std::system(ask.c_str()) == 0 ? newer : "--Sift" + part + ".use_gpu";
}

}  // namespace colmap_seapoint
