#include "colmap_seapoint/commands/matchers.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/commands/loop_pairs.h"
#include "colmap_seapoint/commands/match_pairs.h"
#include "feature/overlap_share.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kBlockSize = 50;  // pictures, as in COLMAP

void SortNaturally(std::vector<DatabaseImage>* images) {
  std::sort(images->begin(), images->end(),
            [](const auto& a, const auto& b) { return NaturalLess(a.name, b.name); });
}

ImagePair OrderedPair(const DatabaseImage& a, const DatabaseImage& b) {
  return std::minmax(a.image_id, b.image_id);
}

// Validate, read, match, write and report: the same for all commands but for what is matched.
template <typename Options, typename MatchImages>
RunReport Match(const std::string& command, const Options& options,
                const MatchImages& match_images) {
  RunReport report = StartReport(command, options, options.run);
  {
    StageTimer timer(&report, command);
    ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadWrite);
    const auto images = ImagesWithSeaPoints(options.database_path, database, &report);
    match_images(images, &database, &report);
    WarnOfLonelyImages(database, images);
  }
  WriteRunReport(options.database_path + "." + command + ".run.json", report);
  return report;
}

void BindDatabase(std::string* path, OptionTable* table) {
  table->AddRequired("database_path", path, "COLMAP database with SeaPoints");
}

}  // namespace

void SequentialPairOptions::Bind(OptionTable* table) {
  table->Add("SequentialMatching.overlap", &overlap,
             "how many following pictures each one is matched with",
             "COLMAP (there 10, and powers of two)", 1, 10000);
  table->Add("SequentialMatching.loop_detection", &loop_detection,
             "also match each picture with those that look like it, wherever they are in the order",
             "COLMAP (there 0, and with a vocabulary to download)");
  table->Add("SequentialMatching.loop_detection_num_images", &loop_detection_num_images,
             "pictures that each one is looked for among, at most", "COLMAP (there 50)", 1, 1000);
}

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

std::vector<ImagePair> SequentialPairs(std::vector<DatabaseImage> images, int overlap) {
  SortNaturally(&images);
  std::vector<ImagePair> pairs;
  for (size_t i = 0; i < images.size(); ++i) {
    const size_t end = std::min(images.size(), i + 1 + static_cast<size_t>(overlap));
    for (size_t j = i + 1; j < end; ++j) pairs.push_back(OrderedPair(images[i], images[j]));
  }
  return pairs;
}

std::vector<ImagePair> ExhaustivePairs(std::vector<DatabaseImage> images) {
  SortNaturally(&images);
  std::vector<ImagePair> pairs;
  for (size_t block1 = 0; block1 < images.size(); block1 += kBlockSize) {
    for (size_t block2 = block1; block2 < images.size(); block2 += kBlockSize) {
      const size_t end1 = std::min(images.size(), block1 + kBlockSize);
      const size_t end2 = std::min(images.size(), block2 + kBlockSize);
      for (size_t i = block1; i < end1; ++i) {
        for (size_t j = std::max(block2, i + 1); j < end2; ++j) {
          pairs.push_back(OrderedPair(images[i], images[j]));
        }
      }
    }
  }
  return pairs;
}

RunReport MatchSequentially(const SequentialMatcherOptions& options) {
  const SequentialPairOptions& choice = options.pairs;
  return Match("sequential_matcher", options,
               [&](std::vector<DatabaseImage> images, ColmapDatabase* database, RunReport* report) {
                 SortNaturally(&images);
                 std::vector<ImagePair> further;
                 if (choice.loop_detection) {
                   StageTimer timer(report, "loop_detection");
                   further = FindLoopPairs(
                       images, {choice.overlap, choice.loop_detection_num_images, options.run},
                       database);
                 }
                 // The next picture overlaps anyway; the others may be round a corner already.
                 const auto next = SequentialPairs(images, 1);
                 const std::set<ImagePair> is_next(next.begin(), next.end());
                 const auto sequential = SequentialPairs(images, choice.overlap);
                 std::copy_if(sequential.begin(), sequential.end(), std::back_inserter(further),
                              [&](const ImagePair& pair) { return is_next.count(pair) == 0; });
                 MatchPairs(next, options.matching, 0, options.run.num_threads, database, report);
                 MatchPairs(further, DemandingOptions(options.matching), kMinOverlapShare,
                            options.run.num_threads, database, report);
               });
}

RunReport MatchExhaustively(const ExhaustiveMatcherOptions& options) {
  return Match(
      "exhaustive_matcher", options,
      [&](const std::vector<DatabaseImage>& images, ColmapDatabase* database, RunReport* report) {
        MatchPairs(ExhaustivePairs(images), options.matching, kMinOverlapShare,
                   options.run.num_threads, database, report);
      });
}

RunReport MatchSpatially(const SpatialMatcherOptions& options) {
  return Match("spatial_matcher", options,
               [&](std::vector<DatabaseImage> images, ColmapDatabase* database, RunReport* report) {
                 SortNaturally(&images);
                 const auto placed = PlaceImages(images, options.pairs, options.image_path,
                                                 options.database_path, *database, report);
                 MatchPairs(SpatialPairs(placed, options.pairs), options.matching, kMinOverlapShare,
                            options.run.num_threads, database, report);
               });
}

ExitCode RunSequentialMatcher(const SequentialMatcherOptions& options) {
  return ExitCodeOf(MatchSequentially(options));
}

ExitCode RunExhaustiveMatcher(const ExhaustiveMatcherOptions& options) {
  return ExitCodeOf(MatchExhaustively(options));
}

ExitCode RunSpatialMatcher(const SpatialMatcherOptions& options) {
  return ExitCodeOf(MatchSpatially(options));
}

}  // namespace colmap_seapoint
