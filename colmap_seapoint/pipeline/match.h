// sequential_matcher, exhaustive_matcher, spatial_matcher: SeaPoints -> `matches` and
// `two_view_geometries`.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/base/options.h"
#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/pairing/pair_options.h"
#include "feature/matching/matching_options.h"

namespace colmap_seapoint {

struct SequentialMatcherOptions {
  std::string database_path;  // COLMAP database with SeaPoints
  SequentialPairOptions pairs;
  SeaPointMatchingOptions matching;
  RunOptions run;

  void Bind(OptionTable* table);
};

struct ExhaustiveMatcherOptions {
  std::string database_path;  // COLMAP database with SeaPoints
  SeaPointMatchingOptions matching;
  RunOptions run;

  void Bind(OptionTable* table);
};

struct SpatialMatcherOptions {
  std::string database_path;  // COLMAP database with SeaPoints
  std::string image_path;     // folder whose EXIF tells places; empty = the database does
  SpatialPairOptions pairs;
  SeaPointMatchingOptions matching;
  RunOptions run;

  void Bind(OptionTable* table);
};

// Matches and verifies every pair that has no row yet, in the order given; also writes
// <database>.<command>.run.json. `database` is the one at options.database_path, open for writing.
// Throws Error when no picture has SeaPoints.
RunReport MatchSequentially(const SequentialMatcherOptions& options, ColmapDatabase* database);
RunReport MatchExhaustively(const ExhaustiveMatcherOptions& options, ColmapDatabase* database);
RunReport MatchSpatially(const SpatialMatcherOptions& options, ColmapDatabase* database);

CommandResult RunSequentialMatcher(const SequentialMatcherOptions& options);
CommandResult RunExhaustiveMatcher(const ExhaustiveMatcherOptions& options);
CommandResult RunSpatialMatcher(const SpatialMatcherOptions& options);

}  // namespace colmap_seapoint
