// automatic_reconstructor: a folder of pictures -> SeaPoints -> matches -> colmap mapper -> dense
// clouds. The same command again goes on where an interrupted run stopped.
#pragma once

#include <map>
#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/georeference/scale_measurements.h"
#include "colmap_seapoint/pictures/image_reader.h"
#include "colmap_seapoint/pipeline/match.h"
#include "densify/partial_densification_options.h"
#include "feature/detector/seapoint_detector.h"
#include "feature/match_features.h"

namespace colmap_seapoint {

// --matcher auto: up to this many pictures, every pair is tried.
inline constexpr size_t kMaxImagesForAllPairs = 50;

struct AutomaticReconstructorOptions {
  std::string image_path;
  std::string workspace_path;
  std::string colmap_path = "colmap";
  std::string quality = "survey";
  std::string matcher = "auto";
  bool adjust_principal_point = true;
  std::string rig;
  ScaleSources scale;
  ImageReaderOptions reader;
  SeaPointExtractionOptions extraction;
  SequentialPairOptions pairs;
  SeaPointMatchingOptions matching;
  std::map<std::string, std::string> mapper;  // "Mapper.<option>" -> value, handed on
  PartialDensificationOptions densification;
  RunOptions run;

  void Bind(OptionTable* table);
  // The SeaPoints' defaults of the quality.
  void Preset();
  // Before any work. Throws UsageError for values that contradict each other, Error for paths that
  // are not there.
  void Check() const;
  ForeignOptions Foreign();
};

CommandResult RunAutomaticReconstructor(const AutomaticReconstructorOptions& options);

}  // namespace colmap_seapoint
