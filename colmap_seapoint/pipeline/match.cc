#include "colmap_seapoint/pipeline/match.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/outputs/run_lock.h"
#include "colmap_seapoint/pairing/loop_pairs.h"
#include "colmap_seapoint/pairing/match_pairs.h"
#include "colmap_seapoint/pairing/pair_lists.h"
#include "colmap_seapoint/pairing/spatial_pairs.h"
#include "colmap_seapoint/workspace/output_paths.h"
#include "feature/matching/overlap_share.h"

namespace colmap_seapoint {
namespace {

// Validate, read, match, write and report: the same for all commands but for what is matched.
template <typename Options, typename MatchImages>
RunReport Match(const std::string& command, const Options& options, const MatchImages& match_images,
                ColmapDatabase* database) {
  const std::filesystem::path report_path = options.database_path + "." + command + ".run.json";
  CheckRunReport(report_path);
  RunReport report = StartReport(command, options, options.run);
  {
    StageTimer timer(&report, command);
    const auto images = ImagesWithSeaPoints(options.database_path, *database, &report);
    match_images(images, &report);
    WarnOfLonelyImages(*database, images);
    database->Finish();
  }
  WriteRunReport(report_path, report);
  return report;
}

// Pairs that were matched with other options are matched again.
std::string Asked(const SeaPointMatchingOptions& options) {
  return std::string(kMatchingVersion) + ":" + OptionsFingerprint(OptionValues(options));
}

void BindDatabase(std::string* path, OptionTable* table) {
  table->AddRequired("database_path", path, "COLMAP database with SeaPoints");
  table->MarkOutput("database_path");
}

}  // namespace

void SequentialMatcherOptions::Bind(OptionTable* table) {
  BindDatabase(&database_path, table);
  pairs.Bind(table);
  matching.Bind(table);
  run.Bind(table);
}

void ExhaustiveMatcherOptions::Bind(OptionTable* table) {
  BindDatabase(&database_path, table);
  matching.Bind(table);
  run.Bind(table);
}

void SpatialMatcherOptions::Bind(OptionTable* table) {
  BindDatabase(&database_path, table);
  table->Add("image_path", &image_path,
             "folder of the pictures: their EXIF tells where they were taken; empty = the database "
             "does",
             "ours");
  pairs.Bind(table);
  matching.Bind(table);
  run.Bind(table);
}

// The next picture overlaps anyway; the others may be round a corner already.
RunReport MatchSequentially(const SequentialMatcherOptions& options, ColmapDatabase* database) {
  const SequentialPairOptions& choice = options.pairs;
  const auto match_images = [&](std::vector<DatabaseImage> images, RunReport* report) {
    SortNaturally(&images);
    std::vector<ImagePair> further;
    if (choice.loop_detection) {
      StageTimer timer(report, "loop_detection");
      further = FindLoopPairs(
          images, {choice.overlap, choice.loop_detection_num_images, options.run}, database);
    }
    const auto next = SequentialPairs(images, 1);
    const std::set<ImagePair> is_next(next.begin(), next.end());
    const auto sequential = SequentialPairs(images, choice.overlap);
    std::copy_if(sequential.begin(), sequential.end(), std::back_inserter(further),
                 [&](const ImagePair& pair) { return is_next.count(pair) == 0; });
    MatchPairs(next, options.matching, Asked(options.matching), 0, options.run.num_threads,
               database, report);
    MatchPairs(further, DemandingOptions(options.matching), Asked(options.matching),
               kMinOverlapShare, options.run.num_threads, database, report);
  };
  return Match("sequential_matcher", options, match_images, database);
}

RunReport MatchExhaustively(const ExhaustiveMatcherOptions& options, ColmapDatabase* database) {
  const auto match_images = [&](const std::vector<DatabaseImage>& images, RunReport* report) {
    MatchPairs(ExhaustivePairs(images), options.matching, Asked(options.matching), kMinOverlapShare,
               options.run.num_threads, database, report);
  };
  return Match("exhaustive_matcher", options, match_images, database);
}

RunReport MatchSpatially(const SpatialMatcherOptions& options, ColmapDatabase* database) {
  const auto match_images = [&](std::vector<DatabaseImage> images, RunReport* report) {
    SortNaturally(&images);
    const auto placed = PlaceImages(images, options.pairs, options.image_path,
                                    options.database_path, *database, report);
    MatchPairs(SpatialPairs(placed, options.pairs), options.matching, Asked(options.matching),
               kMinOverlapShare, options.run.num_threads, database, report);
  };
  return Match("spatial_matcher", options, match_images, database);
}

CommandResult RunSequentialMatcher(const SequentialMatcherOptions& options) {
  CheckOutputPaths(options);
  const RunLock lock = LockFile(options.database_path, "--database_path");
  ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadWrite);
  return ResultOf(MatchSequentially(options, &database));
}

CommandResult RunExhaustiveMatcher(const ExhaustiveMatcherOptions& options) {
  CheckOutputPaths(options);
  const RunLock lock = LockFile(options.database_path, "--database_path");
  ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadWrite);
  return ResultOf(MatchExhaustively(options, &database));
}

CommandResult RunSpatialMatcher(const SpatialMatcherOptions& options) {
  CheckOutputPaths(options);
  const RunLock lock = LockFile(options.database_path, "--database_path");
  ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadWrite);
  return ResultOf(MatchSpatially(options, &database));
}

}  // namespace colmap_seapoint
