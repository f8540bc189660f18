// One row of the feature benchmark: a pair of pictures and a detector. And its CSV form.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "examples/benchmarks/feature/row_csv.h"

namespace colmap_seapoint {

// Shares and areas 0..1; kNotMeasured (an empty field in the file) where nothing could be measured.
struct FeatureRow {
  std::string set, detector, setting, picture1, picture2;
  double gap = 1;  // 1: (V, V+1), intrapair; 2: (V, V+2), interpair
  double points1 = 0, points2 = 0;
  double matches = 0;        // after the flow filter
  double matched_share = 0;  // of the smaller number of points
  double verified = 0;       // inliers of the two-view geometry
  double verified_share = 0;
  double reliable_area = 0;                   // of picture 2, in influence areas of matched points
  double extract_cpu1 = 0, extract_cpu2 = 0;  // detection and description, CPU seconds
  double match_cpu = 0;                       // matching and flow filter, CPU seconds
  double texture_limit = kNotMeasured;        // grey levels; of picture 2
  // Against a survey's truth.
  double precision = kNotMeasured;
  double repeatability = kNotMeasured;
  double true_overlap = kNotMeasured;
  double overlap_error = kNotMeasured;
  double textured = kNotMeasured;
  double recall = kNotMeasured;
  double area_precision = kNotMeasured;
};

void WriteFeatureRows(const std::filesystem::path& path, const std::vector<FeatureRow>& rows);

// Throws Error for a missing file and for anything WriteFeatureRows does not write.
std::vector<FeatureRow> ReadFeatureRows(const std::filesystem::path& path);

}  // namespace colmap_seapoint
