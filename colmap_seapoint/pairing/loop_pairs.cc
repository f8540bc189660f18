#include "colmap_seapoint/pairing/loop_pairs.h"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_loops.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/files/content_hash.h"
#include "colmap_seapoint/pairing/feature_store.h"
#include "feature/feature_levels.h"
#include "feature/retrieval/loop_candidates.h"
#include "feature/retrieval/seapoint_retrieval.h"

namespace colmap_seapoint {
namespace {

// Look-alikes of a picture that are kept for the vote along the sequence.
constexpr size_t kNumRetrieved = 100;

std::string Fingerprint(const std::vector<DatabaseImage>& sequence, const LoopSearch& search,
                        const ColmapDatabase& database) {
  std::string text = kRetrievalVersion;
  for (const int number : {search.overlap, search.num_images, search.run.random_seed}) {
    text += " " + std::to_string(number);
  }
  for (const DatabaseImage& image : sequence) {
    text += "\n" + std::to_string(image.image_id) + " " +
            FeaturesFingerprint(database, image.image_id).value_or("");
  }
  return HashText(text);
}

class LoopFinder {
 public:
  LoopFinder(const std::vector<DatabaseImage>& sequence, const LoopSearch& search,
             ColmapDatabase* database)
      : sequence_(sequence), search_(search), store_(database) {}

  std::vector<LoopCandidate> FindCandidates();

 private:
  std::shared_ptr<const Features> Read(int64_t place);
  SeaPointIndex MakeIndex();
  std::vector<RetrievedPicture> Query(const SeaPointIndex& index, int64_t place);

  const std::vector<DatabaseImage>& sequence_;
  const LoopSearch& search_;
  FeatureStore store_;
};

// Never nullptr: SeaPoints that do not belong to their keypoints any more count as none. Coarser
// levels do not count either: a picture that got a second chance has the loops that it had.
std::shared_ptr<const Features> LoopFinder::Read(int64_t place) {
  auto features = store_.Read(sequence_[static_cast<size_t>(place)].image_id);
  if (features == nullptr) return std::make_shared<const Features>();
  const size_t num_finest = NumFinest(*features);
  if (num_finest == features->points.size()) return features;
  return std::make_shared<const Features>(Slice(*features, 0, num_finest));
}

SeaPointIndex LoopFinder::MakeIndex() {
  const auto count = static_cast<int64_t>(sequence_.size());
  std::vector<Descriptor> sample;
  size_t num_points = 0;
  for (int64_t i = 0; i < count; ++i) {
    const auto features = Read(i);
    num_points += features->points.size();
    AppendSample(*features, &sample);
  }
  SeaPointIndex index(
      SeaPointVocabulary(std::move(sample), NumWordsFor(num_points), search_.run.random_seed),
      num_points);
  const int num_threads = EffectiveNumThreads(search_.run.num_threads);
  OrderedPipeline<SeaPointIndex::Picture>(
      num_threads, count, 4 * num_threads, [&](int64_t i) { return index.MakeEntries(*Read(i)); },
      [&](int64_t, SeaPointIndex::Picture&& picture) { index.Add(picture); });
  index.Finish();
  return index;
}

std::vector<RetrievedPicture> LoopFinder::Query(const SeaPointIndex& index, int64_t place) {
  const auto count = static_cast<int64_t>(sequence_.size());
  std::vector<uint32_t> excluded;
  for (int64_t i = std::max<int64_t>(0, place - search_.overlap);
       i <= std::min(count - 1, place + search_.overlap); ++i) {
    excluded.push_back(static_cast<uint32_t>(i));
  }
  return index.Query(*Read(place), excluded, kNumRetrieved, 1);
}

std::vector<LoopCandidate> LoopFinder::FindCandidates() {
  const SeaPointIndex index = MakeIndex();
  const auto count = static_cast<int64_t>(sequence_.size());
  const int num_threads = EffectiveNumThreads(search_.run.num_threads);
  std::vector<std::vector<RetrievedPicture>> retrieved;
  Progress progress("Look-alikes of pictures", count, 0, Work::kLookAlikes);
  OrderedPipeline<std::vector<RetrievedPicture>>(
      num_threads, count, 4 * num_threads, [&](int64_t i) { return Query(index, i); },
      [&](int64_t i, std::vector<RetrievedPicture>&& of_one) {
        retrieved.push_back(std::move(of_one));
        progress.Update(i + 1);
      });
  progress.Finish();
  return ChooseLoopCandidates(retrieved, search_.overlap, search_.num_images);
}

// Pairs that other matching has given a row, before or after: never ours.
bool IsTaken(const ImagePair& pair, const std::set<ImagePair>& former,
             const ColmapDatabase& database) {
  return former.count(pair) == 0 && HasMatches(database, pair);
}

}  // namespace

std::vector<ImagePair> FindLoopPairs(const std::vector<DatabaseImage>& sequence,
                                     const LoopSearch& search, ColmapDatabase* database) {
  const std::string fingerprint = Fingerprint(sequence, search, *database);
  if (const auto known = ReadLoopPairs(*database, fingerprint)) return *known;
  LoopFinder finder(sequence, search, database);
  const auto former_pairs = ReadLoopPairs(*database);
  const std::set<ImagePair> former(former_pairs.begin(), former_pairs.end());
  std::vector<ImagePair> pairs;
  for (const LoopCandidate& candidate : finder.FindCandidates()) {
    const ImagePair pair =
        std::minmax(sequence[candidate.first].image_id, sequence[candidate.second].image_id);
    if (!IsTaken(pair, former, *database)) pairs.push_back(pair);
  }
  WriteLoopPairs(database, fingerprint, pairs);
  LogInfo(std::to_string(pairs.size()) + " pairs beyond the sequence look alike");
  return pairs;
}

}  // namespace colmap_seapoint
