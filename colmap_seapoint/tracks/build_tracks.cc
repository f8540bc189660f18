#include "colmap_seapoint/tracks/build_tracks.h"

#include <algorithm>
#include <limits>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {

TrackBuilder::TrackBuilder(const std::vector<uint32_t>& num_keypoints) {
  uint64_t total = 0;
  for (const uint32_t count : num_keypoints) {
    begins_.push_back(static_cast<uint32_t>(total));
    total += count;
  }
  SEAPOINT_CHECK(total < std::numeric_limits<uint32_t>::max());
  begins_.push_back(static_cast<uint32_t>(total));
  parents_.resize(total);
  for (uint32_t i = 0; i < parents_.size(); ++i) parents_[i] = i;
}

uint32_t TrackBuilder::RootOf(uint32_t keypoint) {
  while (parents_[keypoint] != keypoint) {
    parents_[keypoint] = parents_[parents_[keypoint]];
    keypoint = parents_[keypoint];
  }
  return keypoint;
}

void TrackBuilder::Add(uint32_t picture_idx1, uint32_t picture_idx2,
                       const FeatureMatches& matches) {
  for (const FeatureMatch& match : matches) {
    const uint32_t keypoint1 = begins_[picture_idx1] + match.idx1;
    const uint32_t keypoint2 = begins_[picture_idx2] + match.idx2;
    SEAPOINT_CHECK(keypoint1 < begins_[picture_idx1 + 1] && keypoint2 < begins_[picture_idx2 + 1]);
    // The smaller one is the root: it is a track's first observation.
    const uint32_t root1 = RootOf(keypoint1), root2 = RootOf(keypoint2);
    parents_[std::max(root1, root2)] = std::min(root1, root2);
  }
}

Tracks TrackBuilder::Build() {
  // Where each root's observations begin. Singles have no place.
  std::vector<uint32_t> lengths(parents_.size(), 0);
  for (uint32_t i = 0; i < parents_.size(); ++i) ++lengths[RootOf(i)];
  std::vector<uint64_t> begins = {0};
  std::vector<uint32_t> track_of_root(parents_.size(), 0);
  for (uint32_t i = 0; i < parents_.size(); ++i) {
    if (lengths[i] < 2) continue;
    track_of_root[i] = static_cast<uint32_t>(begins.size() - 1);
    begins.push_back(begins.back() + lengths[i]);
  }

  std::vector<TrackObservation> observations(begins.back());
  std::vector<uint64_t> ends(begins.begin(), begins.end() - 1);
  for (uint32_t picture = 0; picture + 1 < begins_.size(); ++picture) {
    for (uint32_t i = begins_[picture]; i < begins_[picture + 1]; ++i) {
      const uint32_t root = RootOf(i);
      if (lengths[root] < 2) continue;
      observations[ends[track_of_root[root]]++] = {picture, i - begins_[picture]};
    }
  }

  Tracks tracks;
  for (size_t t = 0; t + 1 < begins.size(); ++t) {
    const auto begin = observations.begin() + static_cast<std::ptrdiff_t>(begins[t]);
    const auto end = observations.begin() + static_cast<std::ptrdiff_t>(begins[t + 1]);
    const auto same_picture = [](const TrackObservation& a, const TrackObservation& b) {
      return a.picture_idx == b.picture_idx;
    };
    if (std::adjacent_find(begin, end, same_picture) != end) continue;
    tracks.observations.insert(tracks.observations.end(), begin, end);
    tracks.begins.push_back(tracks.observations.size());
  }
  return tracks;
}

}  // namespace colmap_seapoint
