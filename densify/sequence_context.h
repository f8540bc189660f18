// What the steps of the two spines, sequence and completion, share: what they work with, and what
// they remember. Internal.
#pragma once

#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "densify/overlap/earlier_surface.h"
#include "densify/overlap/influence_mask.h"
#include "densify/overlap/packed_footprint.h"
#include "densify/partial_densification_options.h"
#include "densify/sequence/covisibility.h"
#include "densify/sequence/picture_cache.h"
#include "densify/sequence/track.h"
#include "densify/sequence_report.h"

namespace colmap_seapoint {

// The same for all pairs. `pictures` is lent memory: it never changes a result.
struct SequenceContext {
  const SparseModel& model;  // with points
  const Covisibility& covisibility;
  const Track& track;
  const PartialDensificationOptions& options;
  DensificationMode mode;  // options.mode and options.redundancy
  Redundancy redundancy;
  int num_threads;
  const SequenceCallbacks& callbacks;
  PictureCache* pictures;
  const SequenceScope& scope;

  // Whether the picture begins pairs. A rig's right one goes with its share of the track.
  bool IsInScope(int position) const {
    if (track.ImageIdx(position) < scope.earlier.num_pictures) return false;
    const int64_t length = track.Length(), num_right = track.NumPictures() - length;
    const int64_t place = position < length ? position : (position - length) * length / num_right;
    return place * scope.num_blocks / length == scope.block - 1;
  }

  std::shared_ptr<const Features> SeaPoints(int position) const {
    return pictures->GetSeaPoints(track.ImageIdx(position));
  }
  std::shared_ptr<const FeatureMatches> Matches(int position1, int position2) const {
    return pictures->GetMatches(track.ImageIdx(position1), track.ImageIdx(position2));
  }
  CellGrid Cells(int position) const { return CellsOf(track.CameraOf(position), options.step); }
  // Of an influence area (paper 2.5), pixels.
  double InfluenceRadius(int position) const {
    return options.influence_radius * track.LongerSide(position);
  }
};

// What one pair leaves to the next ones.
struct SequenceMemory {
  int previous_first = -1;                    // position; -1: no pair yet
  ProcessedPicture previous;                  // that picture, with its labels (paper 2.7)
  std::vector<PackedFootprint> footprints;    // of all partial clouds (ours)
  std::set<std::pair<int, int>> tried_pairs;  // positions, smaller first
};

}  // namespace colmap_seapoint
