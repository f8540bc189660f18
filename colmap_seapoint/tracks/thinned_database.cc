#include "colmap_seapoint/tracks/thinned_database.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "colmap_seapoint/io/colmap/database_copy.h"
#include "colmap_seapoint/io/colmap/database_features.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/tracks/build_tracks.h"
#include "colmap_seapoint/tracks/choose_tracks.h"

namespace colmap_seapoint {
namespace {

constexpr int64_t kPairsPerTransaction = 4096;

// Whether a keypoint belongs to no track, to one, or to a chosen one.
enum class Part : uint8_t { kNone, kTrack, kChosen };
using Parts = std::vector<std::vector<Part>>;  // a picture, a keypoint

class Thinner {
 public:
  Thinner(const ColmapDatabase& database, const ThinningOptions& options)
      : database_(database), options_(options), pairs_(ReadVerifiedPairs(database)) {
    const std::map<uint32_t, Camera> cameras = ReadCameras(database);
    for (const DatabaseImage& image : ReadImages(database)) {
      const auto camera = cameras.find(image.camera_id);
      if (camera == cameras.end()) continue;
      indices_[image.image_id] = static_cast<uint32_t>(pictures_.size());
      pictures_.push_back({camera->second.width, camera->second.height,
                           ReadKeypointPlaces(database, image.image_id)});
    }
  }

  void Choose() {
    Tracks tracks = BuildAll();
    for (const TrackedPicture& picture : pictures_) {
      parts_.emplace_back(picture.keypoints.size(), Part::kNone);
    }
    for (const TrackObservation& observation : tracks.observations) {
      parts_[observation.picture_idx][observation.keypoint_idx] = Part::kTrack;
    }
    for (const uint32_t track :
         ChooseTracks(tracks, pictures_, options_.observations_per_picture)) {
      for (uint64_t i = tracks.begins[track]; i < tracks.begins[track + 1]; ++i) {
        PartOf(tracks.observations[i]) = Part::kChosen;
      }
    }
    for (const ImagePair& pair : pairs_) TopUp(pair);
  }

  Thinning WriteTo(ColmapDatabase* copy) {
    Thinning thinning;
    std::optional<DatabaseTransaction> batch;
    int64_t num_written = 0;
    for (const ImagePair& pair : pairs_) {
      if (!batch) batch.emplace(copy);
      TwoViewGeometry geometry = ReadTwoViewGeometry(database_, pair);
      thinning.num_matches += static_cast<int64_t>(geometry.inliers.size());
      geometry.inliers = ChosenOf(pair, geometry.inliers);
      thinning.num_chosen_matches += static_cast<int64_t>(geometry.inliers.size());
      WriteMatches(copy, pair.first, pair.second, geometry.inliers, geometry);
      if (++num_written % kPairsPerTransaction == 0) {
        batch->Commit();
        batch.reset();
      }
    }
    if (batch) batch->Commit();
    return thinning;
  }

 private:
  Part& PartOf(const TrackObservation& observation) {
    return parts_[observation.picture_idx][observation.keypoint_idx];
  }

  Part& PartOf(uint32_t image_id, uint32_t keypoint_idx) {
    return parts_[indices_.at(image_id)][keypoint_idx];
  }

  Tracks BuildAll() const {
    std::vector<uint32_t> num_keypoints;
    for (const TrackedPicture& picture : pictures_) {
      num_keypoints.push_back(static_cast<uint32_t>(picture.keypoints.size()));
    }
    TrackBuilder builder(num_keypoints);
    for (const ImagePair& pair : pairs_) {
      builder.Add(indices_.at(pair.first), indices_.at(pair.second),
                  ReadTwoViewGeometry(database_, pair).inliers);
    }
    return builder.Build();
  }

  // Chooses more of a pair's matches until it has its least number, evenly over their order, which
  // is that of their places in the picture.
  void TopUp(const ImagePair& pair) {
    const auto wanted = static_cast<size_t>(options_.min_matches_per_pair);
    const FeatureMatches matches = ReadTwoViewGeometry(database_, pair).inliers;
    const size_t num_chosen = ChosenOf(pair, matches).size();
    if (num_chosen >= wanted) return;
    FeatureMatches left;
    for (const FeatureMatch& match : matches) {
      if (PartOf(pair.first, match.idx1) == Part::kTrack &&
          PartOf(pair.second, match.idx2) == Part::kTrack) {
        left.push_back(match);
      }
    }
    const size_t count = std::min(left.size(), wanted - num_chosen);
    for (size_t i = 0; i < count; ++i) {
      const FeatureMatch& match = left[i * left.size() / count];
      PartOf(pair.first, match.idx1) = Part::kChosen;
      PartOf(pair.second, match.idx2) = Part::kChosen;
    }
  }

  FeatureMatches ChosenOf(const ImagePair& pair, const FeatureMatches& matches) {
    FeatureMatches chosen;
    for (const FeatureMatch& match : matches) {
      if (PartOf(pair.first, match.idx1) == Part::kChosen &&
          PartOf(pair.second, match.idx2) == Part::kChosen) {
        chosen.push_back(match);
      }
    }
    return chosen;
  }

  const ColmapDatabase& database_;
  const ThinningOptions options_;
  const std::vector<ImagePair> pairs_;
  std::map<uint32_t, uint32_t> indices_;  // of pictures, by image id
  std::vector<TrackedPicture> pictures_;
  Parts parts_;
};

}  // namespace

Thinning WriteThinnedDatabase(const ColmapDatabase& database, const ThinningOptions& options,
                              const std::filesystem::path& copy) {
  Thinner thinner(database, options);
  thinner.Choose();
  CopyDatabase(database, copy);
  ColmapDatabase written(copy, ColmapDatabase::Mode::kReadWrite, ColmapDatabase::Check::kNone);
  const Thinning thinning = thinner.WriteTo(&written);
  written.Finish();
  return thinning;
}

}  // namespace colmap_seapoint
