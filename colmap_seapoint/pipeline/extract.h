// feature_extractor: pictures -> cameras, images and SeaPoints in the database.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "feature/extract_features.h"

namespace colmap_seapoint {

struct FeatureExtractorOptions {
  std::string database_path;
  std::string image_path;
  std::string image_list_path;
  ImageReaderOptions reader;
  SeaPointExtractionOptions extraction;
  RunOptions run;

  void Bind(OptionTable* table);
};

inline constexpr int kSecondChanceLevels = 5;

// Sees the readable pictures before the database is opened (or created). Returns the names of those
// that get SI-SeaPoints of kSecondChanceLevels levels instead (see second_chance.h).
using PrepareExtraction =
    std::function<std::set<std::string>(const std::vector<ReadablePicture>& pictures)>;

// Extracts the pictures whose file, mask or options changed, and leaves the others alone. Also
// writes <database>.feature_extractor.run.json. Throws Error when no picture is usable, or when the
// database holds keypoints of other software for one of them (nothing is written then).
RunReport ExtractPictures(const FeatureExtractorOptions& options,
                          const PrepareExtraction& prepare = {});

CommandResult RunFeatureExtractor(const FeatureExtractorOptions& options);

}  // namespace colmap_seapoint
