#include "colmap_seapoint/pairing/match_pairs.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/pairing/feature_store.h"
#include "feature/match_levels.h"

namespace colmap_seapoint {
namespace {

constexpr int64_t kPairsPerTransaction = 32;
constexpr size_t kNamesInWarning = 5;
// Fewer agree by chance, and guided matching then makes many of them. Of 2,803 pairs without any
// overlap, in a synthetic dive of 2,000 pictures, two passed with 15 and none with 30.
constexpr int kDemandingInliers = 30;

struct PairsToMatch {
  std::vector<ImagePair> pairs;
  int64_t num_again = 0;  // of them, matched before with other options
};

PairsToMatch FindPairsToMatch(const std::vector<ImagePair>& pairs, const std::string& asked,
                              const ColmapDatabase& database) {
  const std::set<ImagePair> otherwise = PairsMatchedOtherwise(database, asked);
  PairsToMatch found;
  for (const ImagePair& pair : pairs) {
    if (HasMatches(database, pair)) {
      if (otherwise.count(std::minmax(pair.first, pair.second)) == 0) continue;
      ++found.num_again;
    }
    found.pairs.push_back(pair);
  }
  return found;
}

const Camera& CameraOf(uint32_t image_id, const std::map<uint32_t, Camera>& cameras,
                       const std::map<uint32_t, DatabaseImage>& images) {
  const DatabaseImage& image = images.at(image_id);
  const auto camera = cameras.find(image.camera_id);
  if (camera != cameras.end()) return camera->second;
  throw Error(image.name,
              "its camera " + std::to_string(image.camera_id) + " is not in the database",
              "repair the database, or run feature_extractor into a new one");
}

MatchedPair MatchOne(const Camera& camera1, const std::shared_ptr<const Features>& features1,
                     const Camera& camera2, const std::shared_ptr<const Features>& features2,
                     const SeaPointMatchingOptions& options, double min_overlap_share) {
  TwoViewGeometry unverified;
  unverified.config = TwoViewConfig::kDegenerate;
  if (features1 == nullptr || features2 == nullptr) return {{}, unverified};
  if (features1->points.empty() || features2->points.empty()) return {{}, unverified};
  return MatchLevels(camera1, *features1, camera2, *features2, options, min_overlap_share);
}

}  // namespace

std::vector<DatabaseImage> ImagesWithSeaPoints(const std::string& database_path,
                                               const ColmapDatabase& database, RunReport* report) {
  const std::vector<DatabaseImage> images = ReadImages(database);
  report->images_in = static_cast<int64_t>(images.size());
  std::vector<DatabaseImage> usable;
  for (const DatabaseImage& image : images) {
    if (FeaturesFingerprint(database, image.image_id)) usable.push_back(image);
  }
  if (usable.empty()) {
    throw Error(database_path,
                "none of its " + std::to_string(images.size()) + " images has SeaPoints",
                "run colmap_seapoint feature_extractor on it first");
  }
  for (const DatabaseImage& image : images) {
    if (!FeaturesFingerprint(database, image.image_id)) {
      LeaveOut(image.name, "has no SeaPoints in the database", report);
    }
  }
  report->images_used = static_cast<int64_t>(usable.size());
  return usable;
}

void MatchPairs(const std::vector<ImagePair>& pairs, const SeaPointMatchingOptions& options,
                const std::string& asked, double min_overlap_share, int num_threads,
                ColmapDatabase* database, RunReport* report) {
  const std::map<uint32_t, Camera> cameras = ReadCameras(*database);
  std::map<uint32_t, DatabaseImage> images;
  for (const DatabaseImage& image : ReadImages(*database)) images[image.image_id] = image;
  const PairsToMatch to_do = FindPairsToMatch(pairs, asked, *database);
  const std::vector<ImagePair>& missing = to_do.pairs;
  if (to_do.num_again > 0) {
    LogInfo(std::to_string(to_do.num_again) + " pairs were matched with other options: once more");
  }
  const auto total = static_cast<int64_t>(pairs.size());
  const auto count = static_cast<int64_t>(missing.size());
  FeatureStore store(database);
  std::optional<DatabaseTransaction> batch;
  Progress progress("Matches of pairs", total, total - count, Work::kPairs);
  num_threads = EffectiveNumThreads(num_threads);
  OrderedPipeline<MatchedPair>(
      num_threads, count, 4 * num_threads,
      [&](int64_t i) {
        const auto [id1, id2] = missing[static_cast<size_t>(i)];
        return MatchOne(CameraOf(id1, cameras, images), store.Read(id1),
                        CameraOf(id2, cameras, images), store.Read(id2), options,
                        min_overlap_share);
      },
      [&](int64_t i, MatchedPair&& matched) {
        const auto [id1, id2] = missing[static_cast<size_t>(i)];
        std::lock_guard<std::mutex> lock(store.Mutex());
        if (!batch) batch.emplace(database);
        WriteMatches(database, id1, id2, matched.matches, matched.geometry);
        NoteMatching(database, std::minmax(id1, id2), asked);
        if ((i + 1) % kPairsPerTransaction == 0 || i + 1 == count) {
          batch->Commit();
          batch.reset();
        }
        progress.Update(total - count + i + 1);
      });
  progress.Finish();
  if (count < total) LogInfo(std::to_string(total - count) + " pairs were there already");
  report->pairs += total;
}

SeaPointMatchingOptions DemandingOptions(const SeaPointMatchingOptions& options) {
  SeaPointMatchingOptions demanding = options;
  demanding.verification.min_num_inliers =
      std::max(options.verification.min_num_inliers, kDemandingInliers);
  return demanding;
}

void WarnOfLonelyImages(const ColmapDatabase& database, const std::vector<DatabaseImage>& images) {
  if (images.size() < 2) return;
  std::set<uint32_t> matched;
  for (const ImagePair& pair : ReadVerifiedPairs(database)) {
    matched.insert(pair.first);
    matched.insert(pair.second);
  }
  std::vector<std::string> lonely;
  for (const DatabaseImage& image : images) {
    if (matched.count(image.image_id) == 0) lonely.push_back(image.name);
  }
  if (lonely.empty()) return;
  std::string line = std::to_string(lonely.size()) + " of " + std::to_string(images.size()) +
                     " pictures match no other one:";
  for (size_t i = 0; i < lonely.size() && i < kNamesInWarning; ++i) line += " " + lonely[i];
  LogWarning(line + (lonely.size() > kNamesInWarning ? " ..." : ""));
}

}  // namespace colmap_seapoint
