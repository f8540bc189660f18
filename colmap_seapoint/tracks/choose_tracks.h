// Which of a survey's tracks posing needs (ours).
//
// The mapper's time grows with the observations, its poses hardly get better: a few hundred, spread
// over the picture and seen from as many pictures as can be, hold a picture as firmly as thousands.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "colmap_seapoint/tracks/build_tracks.h"

namespace colmap_seapoint {

// What is known of one picture.
struct TrackedPicture {
  int width = 0;  // pixels
  int height = 0;
  std::vector<Eigen::Vector2f> keypoints;  // pixels
};

// Numbers of tracks, ascending. Long tracks come first; one is chosen while at least half of its
// observations lie in cells (8 x 8 a picture) that hold fewer than their share of
// `observations_per_picture`, or one lies in a picture that has less than half of them: pictures
// that are tied by little keep all that ties them.
std::vector<uint32_t> ChooseTracks(const Tracks& tracks,
                                   const std::vector<TrackedPicture>& pictures,
                                   int observations_per_picture);

}  // namespace colmap_seapoint
