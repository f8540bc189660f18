// The track: what every picture shares with the next one, and where the vehicle should have moved
// otherwise (paper 4: hints for navigation).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

struct TrackPicture {
  int image_idx = 0;
  Eigen::Vector3d center, axis;  // world; axis: unit, along the view
  double distance = 0;           // of the surface in its middle: median depth of its points, units
  double covered = 0;            // share of its cells (PictureRecord)
  // Of its points that lie in the next picture of its folder, 0..1; -1: it is the last one, or has
  // fewer than 10 points.
  double overlap = -1;
};

// Grey value, the mean over a picture, 0..255; -1: unknown.
struct TrackInput {
  const SparseModel* model = nullptr;  // with points and their ids by image
  const std::vector<PictureRecord>* records = nullptr;
  const std::vector<double>* brightness = nullptr;  // by image_idx
};

// Of every folder in natural order, folders in order of their names.
std::vector<TrackPicture> FollowTrack(const TrackInput& input);

struct TrackHint {
  std::string text;         // one line, without the pictures' names
  int first = 0, last = 0;  // positions in the track that it holds for
};

// Where overlap fell below one half (a place is then in one picture alone), where it was much
// higher, lower or darker than the survey's median; neighbours in one line. At most 20, the
// longest stretches first, then in order of the track.
std::vector<TrackHint> HintsOf(const TrackInput& input, const std::vector<TrackPicture>& track);

}  // namespace colmap_seapoint
