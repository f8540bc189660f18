// feature_extractor: pictures -> cameras, images and SeaPoints in the database.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "feature/extract_features.h"

namespace colmap_seapoint {

// Behind the fingerprint of a picture that got SI-SeaPoints, its own SeaPoints being as before.
inline constexpr char kSecondChanceMark[] = ":second chance";

struct FeatureExtractorOptions {
  std::string database_path;    // COLMAP database, created when it does not exist
  std::string image_path;       // folder, sub-folders included
  std::string image_list_path;  // names of the pictures to take, one a line; empty = all
  ImageReaderOptions reader;
  SeaPointExtractionOptions extraction;
  RunOptions run;

  void Bind(OptionTable* table);
  void Preset() { reader.Preset(); }
};

// The pictures of a folder: those whose header can be read, and what became of the others.
struct PictureSet {
  int64_t num_listed = 0;
  std::vector<ReadablePicture> readable;
  std::vector<RunReport::LeftOut> left_out;
};

// The pictures of the folder, or of the list where one is given. Throws Error when none can be
// read.
PictureSet ReadPictureSet(const FeatureExtractorOptions& options);

// Extracts the pictures whose file, mask or options changed, and leaves the others alone; those in
// `second_chance_names` get SI-SeaPoints beside their own (ExtractSecondChance). Also writes
// <database>.feature_extractor.run.json. Each picture's file is read once. Throws Error when no
// picture is usable, or when the database holds keypoints of other software for one of them
// (nothing is written then).
RunReport ExtractPictures(const FeatureExtractorOptions& options, const PictureSet& pictures,
                          const std::set<std::string>& second_chance_names,
                          ColmapDatabase* database);

CommandResult RunFeatureExtractor(const FeatureExtractorOptions& options);

}  // namespace colmap_seapoint
