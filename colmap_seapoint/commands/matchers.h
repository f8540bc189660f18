// sequential_matcher, exhaustive_matcher, spatial_matcher: SeaPoints -> `matches` and
// `two_view_geometries`.
// `two_view_geometries`.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/commands/command.h"
#include "colmap_seapoint/commands/run_options.h"
#include "colmap_seapoint/commands/spatial_pairs.h"
#include "colmap_seapoint/io/colmap_database.h"
#include "feature/match_features.h"

namespace colmap_seapoint {

struct SequentialPairOptions {
  int overlap = 5;
  bool loop_detection = true;
  int loop_detection_num_images = 10;

  void Bind(OptionTable* table);
};

struct SequentialMatcherOptions {
  std::string database_path;
  SequentialPairOptions pairs;
  SeaPointMatchingOptions matching;
  RunOptions run;

  void Bind(OptionTable* table);
};

struct ExhaustiveMatcherOptions {
  std::string database_path;
  SeaPointMatchingOptions matching;
  RunOptions run;

  void Bind(OptionTable* table);
};

struct SpatialMatcherOptions {
  std::string database_path;
  std::string image_path;
  SpatialPairOptions pairs;
  SeaPointMatchingOptions matching;
  RunOptions run;

  void Bind(OptionTable* table);
};

// Pictures in the natural order of their whole names, each with its `overlap` successors: as in
// COLMAP, a sequence goes on from one folder into the next.
std::vector<ImagePair> SequentialPairs(std::vector<DatabaseImage> images, int overlap);

// Every pair, in blocks of pictures, so that few pictures are needed at a time.
std::vector<ImagePair> ExhaustivePairs(std::vector<DatabaseImage> images);

// Matches and verifies every pair that has no row yet, in the order given; also writes
// <database>.<command>.run.json. Throws Error when no picture has SeaPoints.
RunReport MatchSequentially(const SequentialMatcherOptions& options);
RunReport MatchExhaustively(const ExhaustiveMatcherOptions& options);
RunReport MatchSpatially(const SpatialMatcherOptions& options);

ExitCode RunSequentialMatcher(const SequentialMatcherOptions& options);
ExitCode RunExhaustiveMatcher(const ExhaustiveMatcherOptions& options);
ExitCode RunSpatialMatcher(const SpatialMatcherOptions& options);

}  // namespace colmap_seapoint
