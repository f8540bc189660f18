// A survey's tracks (ours): which SeaPoints of different pictures show one place on the ground.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/features.h"

namespace colmap_seapoint {

// Pictures are counted from zero here, in the order of `num_keypoints`.
struct TrackObservation {
  uint32_t picture_idx = 0;
  uint32_t keypoint_idx = 0;
  friend bool operator==(const TrackObservation& a, const TrackObservation& b) {
    return a.picture_idx == b.picture_idx && a.keypoint_idx == b.keypoint_idx;
  }
};

// Track t has the observations begins[t] to begins[t + 1], by picture.
struct Tracks {
  std::vector<uint64_t> begins = {0};
  std::vector<TrackObservation> observations;

  size_t Count() const { return begins.size() - 1; }
};

// Matches come in, pair by pair; what they join is one track. 4 bytes a keypoint while it grows.
class TrackBuilder {
 public:
  explicit TrackBuilder(const std::vector<uint32_t>& num_keypoints);

  // Every index must be below its picture's number of keypoints.
  void Add(uint32_t picture_idx1, uint32_t picture_idx2, const FeatureMatches& matches);

  // Tracks in the order of their first observations. One that shows a picture twice holds a false
  // match at least, nobody can tell which: it is left out whole. So the order of the pairs does not
  // matter.
  Tracks Build();

 private:
  uint32_t RootOf(uint32_t keypoint);

  std::vector<uint32_t> begins_;   // of a picture's keypoints among all
  std::vector<uint32_t> parents_;  // of each keypoint; a root is its own
};

}  // namespace colmap_seapoint
