#include "colmap_seapoint/pairing/tilted_pairs.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/camera.h"
#include "colmap_seapoint/base/parallel.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "feature/feature_levels.h"
#include "feature/matching/two_view_verification.h"
#include "feature/tilted_view.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMinMatches = 100;
constexpr size_t kTied = 30;  // what COLMAP's mapper asks for to register a picture

struct Picture {
  std::string name;
  Camera camera;
  TiltedView view;
};

struct PairRows {
  FeatureMatches raw;
  TwoViewGeometry geometry;
};

using Pictures = std::map<uint32_t, Picture>;
using Found = std::map<ImagePair, FeatureMatches>;  // verified, between the views' points

// Steps of one kind, counted as they are done, in their order.
template <typename Result, typename Make, typename Take>
void CountedSteps(const TiltedPairsJob& job, const char* what, size_t count, const Make& make,
                  const Take& take) {
  Progress progress(what, static_cast<int64_t>(count), 0, Work::kTiltedViews);
  const int threads = EffectiveNumThreads(job.num_threads);
  OrderedPipeline<Result>(
      threads, static_cast<int64_t>(count), 2 * threads,
      [&](int64_t i) { return make(static_cast<size_t>(i)); },
      [&](int64_t i, Result&& result) {
        take(static_cast<size_t>(i), std::move(result));
        progress.Update(i + 1);
      });
}

Pictures ViewsOf(const TiltedPairsJob& job, const ColmapDatabase& database) {
  const std::map<uint32_t, Camera> cameras = ReadCameras(database);
  std::vector<std::pair<uint32_t, Picture>> pictures;
  for (const DatabaseImage& image : ReadImages(database)) {
    if (job.groups.count(image.image_id) == 0) continue;
    pictures.push_back({image.image_id, {image.name, cameras.at(image.camera_id), {}}});
  }
  CountedSteps<TiltedView>(
      job, "Views from above", pictures.size(),
      [&](size_t i) {
        const Picture& picture = pictures[i].second;
        const MaskedPicture read = job.read(picture.name);
        return ExtractTiltedView(read.picture, read.mask, picture.camera, job.tilt_deg,
                                 job.extraction);
      },
      [&](size_t i, TiltedView&& view) { pictures[i].second.view = std::move(view); });
  return Pictures(pictures.begin(), pictures.end());
}

void MatchViews(const TiltedPairsJob& job, const Pictures& pictures,
                const std::vector<ImagePair>& pairs, Found* found) {
  CountedSteps<FeatureMatches>(
      job, "Matches of views from above", pairs.size(),
      [&](size_t i) {
        const TiltedView& view1 = pictures.at(pairs[i].first).view;
        const TiltedView& view2 = pictures.at(pairs[i].second).view;
        if (view1.features.points.empty() || view2.features.points.empty()) return FeatureMatches();
        return MatchFeatures(view1.camera, view1.features, view2.camera, view2.features,
                             job.matching)
            .geometry.inliers;
      },
      [&](size_t i, FeatureMatches&& matches) {
        if (matches.size() >= kMinMatches) (*found)[pairs[i]] = std::move(matches);
      });
}

// Pairs of different groups first; then, of the pictures that those tied, their pairs within.
Found FindTies(const TiltedPairsJob& job, const Pictures& pictures,
               const ColmapDatabase& database) {
  std::vector<ImagePair> across, within;
  for (const ImagePair& pair : ReadTriedPairs(database)) {
    if (pictures.count(pair.first) == 0 || pictures.count(pair.second) == 0) continue;
    const bool is_within = job.groups.at(pair.first) == job.groups.at(pair.second);
    (is_within ? within : across).push_back(pair);
  }
  Found found;
  MatchViews(job, pictures, across, &found);
  std::set<uint32_t> tying;
  for (const auto& [pair, matches] : found) tying.insert({pair.first, pair.second});
  std::vector<ImagePair> supporting;
  for (const ImagePair& pair : within) {
    if (tying.count(pair.first) == 0 && tying.count(pair.second) == 0) continue;
    if (ReadTwoViewGeometry(database, pair).inliers.size() >= kTied) supporting.push_back(pair);
  }
  MatchViews(job, pictures, supporting, &found);
  return found;
}

// A picture's features, to which the matched ones of its view are added.
class GrowingFeatures {
 public:
  GrowingFeatures(Features features, const TiltedView& view)
      : features_(std::move(features)), view_(view) {}

  // The number here of a point of the view.
  uint32_t Take(uint32_t view_idx) {
    const auto [known, is_new] =
        numbers_.insert({view_idx, static_cast<uint32_t>(features_.points.size())});
    if (!is_new) return known->second;
    SeaPoint point = view_.features.points[view_idx];
    point.x = static_cast<float>(view_.in_picture[view_idx].x());
    point.y = static_cast<float>(view_.in_picture[view_idx].y());
    features_.points.push_back(point);
    features_.descriptors.push_back(view_.features.descriptors[view_idx]);
    if (!features_.sift_descriptors.empty()) {
      features_.sift_descriptors.push_back(view_.features.sift_descriptors[view_idx]);
    }
    return known->second;
  }

  const Features& Get() const { return features_; }

 private:
  Features features_;
  const TiltedView& view_;
  std::map<uint32_t, uint32_t> numbers_;
};

using Growing = std::map<uint32_t, GrowingFeatures>;

// The pair's rows with what was found, verified as one; as they were where that would lose.
PairRows Extended(const PairRows& rows, const FeatureMatches& added, const Camera& camera1,
                  const Features& features1, const Camera& camera2, const Features& features2,
                  const TwoViewVerificationOptions& options) {
  FeatureMatches all = rows.geometry.inliers;
  all.insert(all.end(), added.begin(), added.end());
  PairRows extended = {
      rows.raw, VerifyTwoViews(camera1, features1.points, camera2, features2.points, all, options)};
  if (extended.geometry.inliers.size() < std::max(kMinMatches, rows.geometry.inliers.size())) {
    return rows;
  }
  extended.raw.insert(extended.raw.end(), added.begin(), added.end());
  return extended;
}

// Rows of all pairs of these pictures: new features would take them away.
std::map<ImagePair, PairRows> RowsOf(const Growing& growing, const ColmapDatabase& database) {
  std::map<ImagePair, PairRows> rows;
  for (const ImagePair& pair : ReadTriedPairs(database)) {
    if (growing.count(pair.first) == 0 && growing.count(pair.second) == 0) continue;
    rows[pair] = {ReadMatches(database, pair), ReadTwoViewGeometry(database, pair)};
  }
  return rows;
}

void Write(const Growing& growing, const std::map<ImagePair, PairRows>& rows,
           ColmapDatabase* database) {
  for (const auto& [id, features] : growing) {
    std::string fingerprint = FeaturesFingerprint(*database, id).value_or("");
    if (fingerprint.find(kTiltedMark) == std::string::npos) fingerprint += kTiltedMark;
    WriteFeatures(database, id, features.Get(), fingerprint);
  }
  for (const auto& [pair, row] : rows) {
    WriteMatches(database, pair.first, pair.second, row.raw, row.geometry);
  }
}

}  // namespace

int64_t TieByTiltedViews(const TiltedPairsJob& job, ColmapDatabase* database) {
  const Pictures pictures = ViewsOf(job, *database);
  const Found found = FindTies(job, pictures, *database);
  if (found.empty()) return 0;
  Growing growing;
  for (const auto& [pair, matches] : found) {
    for (const uint32_t id : {pair.first, pair.second}) {
      if (growing.count(id) > 0) continue;
      growing.emplace(id, GrowingFeatures(ReadFeatures(*database, id).value_or(Features()),
                                          pictures.at(id).view));
    }
  }
  std::map<ImagePair, PairRows> rows = RowsOf(growing, *database);
  int64_t num_tied = 0;
  for (const auto& [pair, matches] : found) {
    GrowingFeatures& features1 = growing.at(pair.first);
    GrowingFeatures& features2 = growing.at(pair.second);
    FeatureMatches added;
    for (const FeatureMatch& match : matches) {
      added.push_back({features1.Take(match.idx1), features2.Take(match.idx2)});
    }
    PairRows& row = rows[pair];
    const size_t num_before = row.geometry.inliers.size();
    row = Extended(row, added, pictures.at(pair.first).camera, features1.Get(),
                   pictures.at(pair.second).camera, features2.Get(), job.matching.verification);
    if (num_before < kTied && row.geometry.inliers.size() >= kTied) ++num_tied;
  }
  Write(growing, rows, database);
  return num_tied;
}

}  // namespace colmap_seapoint
