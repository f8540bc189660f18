#include "colmap_seapoint/commands/matchers.h"

#include <algorithm>

#include "colmap_seapoint/base/natural_order.h"
#include "colmap_seapoint/commands/match_pairs.h"

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

// Validate, read, match, write and report: the same for both commands but for the list of pairs.
template <typename Options, typename ListPairs>
RunReport Match(const std::string& command, const Options& options, const ListPairs& list_pairs) {
  RunReport report = StartReport(command, options, options.run);
  {
    StageTimer timer(&report, command);
    ColmapDatabase database(options.database_path, ColmapDatabase::Mode::kReadWrite);
    const auto pairs = list_pairs(ImagesWithSeaPoints(options.database_path, database, &report));
    MatchPairs(pairs, options.matching, options.run.num_threads, &database, &report);
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
  return Match("sequential_matcher", options, [&](const std::vector<DatabaseImage>& images) {
    return SequentialPairs(images, options.pairs.overlap);
  });
}

RunReport MatchExhaustively(const ExhaustiveMatcherOptions& options) {
  return Match("exhaustive_matcher", options, ExhaustivePairs);
}

ExitCode RunSequentialMatcher(const SequentialMatcherOptions& options) {
  return ExitCodeOf(MatchSequentially(options));
}

ExitCode RunExhaustiveMatcher(const ExhaustiveMatcherOptions& options) {
  return ExitCodeOf(MatchExhaustively(options));
}

}  // namespace colmap_seapoint
