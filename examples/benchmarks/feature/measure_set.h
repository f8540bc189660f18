// Measures the detectors on one folder of pictures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "examples/benchmarks/feature/feature_rows.h"

namespace colmap_seapoint {

struct MeasureOptions {
  std::string set_name;
  std::filesystem::path image_path;                  // pictures, taken in natural order
  std::optional<std::filesystem::path> survey_path;  // demo survey they belong to
  int min_num_features = 2500, max_num_features = 3000;
  bool adjust_thresholds = true;  // of ORB and SIFT, so that they find enough points
  int num_repeats = 3;  // timings of one picture or pair; detectors take turns; the median counts
};

// Rows of all pairs (V, V+1) and (V, V+2). Runs everything on the caller's thread, beside the
// threads that OpenCV starts. CPU seconds are user + sys of the whole process; decoding is not
// among them. Progress on stderr. Throws Error for unreadable pictures and fewer than two.
std::vector<FeatureRow> MeasureSet(const MeasureOptions& options);

}  // namespace colmap_seapoint
