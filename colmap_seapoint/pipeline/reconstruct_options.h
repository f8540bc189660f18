// The options of automatic_reconstructor: every group's of the chain.
#pragma once

#include <map>
#include <string>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/frames/frame_options.h"
#include "colmap_seapoint/georeference/scale_sources.h"
#include "colmap_seapoint/pairing/pair_options.h"
#include "colmap_seapoint/pictures/image_reader_options.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_settings.h"
#include "densify/completeness/completeness_options.h"
#include "densify/partial_densification_options.h"
#include "feature/detector/seapoint_detector.h"
#include "feature/matching/matching_options.h"

namespace colmap_seapoint {

// --matcher auto: up to this many pictures, every pair is tried.
inline constexpr size_t kMaxImagesForAllPairs = 50;

struct AutomaticReconstructorOptions {
  std::string image_path;              // folder, sub-folders included; or a video
  std::string workspace_path;          // folder, created when missing
  std::string colmap_path = "colmap";  // a path, or a name on PATH
  double colmap_timeout = 0;           // seconds that one run of it may take; 0 = no limit
  std::string quality = "survey";      // field, survey or archive: what posing may cost
  std::string matcher = "auto";        // auto, sequential or exhaustive
  bool adjust_principal_point = true;
  bool join_models = true;
  bool check_disk = true;
  bool estimate_only = false;
  bool watch = false;
  double pause_on_battery = 0;  // percent; 0 = never
  double watch_idle = 0;        // seconds; 0 = until Ctrl-C
  std::string rig;
  ScaleSources scale;
  FrameSelectionOptions frames;
  ImageReaderOptions reader;
  SeaPointExtractionOptions extraction;
  SequentialPairOptions pairs;
  SeaPointMatchingOptions matching;
  std::map<std::string, std::string> mapper;  // "Mapper.<option>" -> value, handed on
  PartialDensificationOptions densification;
  bool makes_map = true;
  MapSettings map;
  bool report_completeness = true;
  CompletenessOptions completeness;
  RunOptions run;

  void Bind(OptionTable* table);
  // The SeaPoints' defaults of the quality, the camera model of the preset.
  void Preset();
  // To be called before any work. Throws UsageError for values that contradict each other, Error
  // for paths that are not there.
  void Check() const;
  ForeignOptions Foreign();

 private:
  void BindField(OptionTable* table);
};

// Whether the user says what of the lens the mapper is to refine.
bool GivesRefinement(const AutomaticReconstructorOptions& options);

}  // namespace colmap_seapoint
