// What densification remembers from pair to pair: the labels of the last first picture (paper 2.7)
// and the footprints of all partial clouds (ours). The steps of the spine in densify_sequence.cc.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "densify/densify_pair.h"
#include "densify/densify_sequence.h"
#include "densify/overlap/coverage.h"
#include "densify/overlap/influence_mask.h"
#include "densify/sequence/completion.h"
#include "densify/sequence/picture_cache.h"

namespace colmap_seapoint {

// Positions are those of the sequence; those of a rig's right pictures come after the track.
class SequenceState {
 public:
  // `order`: image_idx by position, right pictures last.
  SequenceState(const SparseModel& model, std::vector<int> order, const StereoRig& rig,
                PictureSource* source, const PartialDensificationOptions& options, int num_threads,
                const SequenceCallbacks& callbacks);

  int NumPictures() const { return static_cast<int>(order_.size()); }

  // Whether another picture follows on the track, or `first` has a simultaneous one.
  bool CanStartPair(int first) const;
  // The picture that completes the pair of `first`: its simultaneous right one (paper 4); else, of
  // those that follow, the next one with enough motion (paper 2.6) or, with a completion pass
  // (ours), the one with the widest baseline of those that see most of the same. NumPictures() when
  // there is none: reported as skipped.
  int SelectSecond(int first);
  // Overlap, labels, seeds, propagation, reprojection (paper 2.5 to 2.7).
  void DensifyNewAreas(int first, int second);
  int SelectNextFirst(int first, int second);
  // Ours: what this picture sees, some other picture sees too, and no pair has covered.
  void Complete(int position);

  SequenceReport TakeReport();

 private:
  // What came before, as this pair has to know it (paper 2.5; ours for redundancy "all").
  struct Overlap {
    InfluenceMask mask;                 // no cells: there is no pair before
    std::vector<uint8_t> closed;        // sequential
    std::vector<float> covered_range;   // all
    std::vector<SeaPointLabel> labels;  // of the first picture's SeaPoints
    double rate = 0;
  };

  struct SecondCandidate {
    int position;
    double parallax_deg;  // median, of the points shared with the first picture
  };

  View ViewAt(int position) const;
  const PosedImage& ImageAt(int position) const;
  int ImageIdxAt(int position) const { return order_[static_cast<size_t>(position)]; }
  int RightOf(int position) const { return right_of_[static_cast<size_t>(position)]; }
  double LongerSide(int position) const;
  CellGrid CellsAt(int position) const;

  std::shared_ptr<const Features> SeaPointsAt(int position);
  std::shared_ptr<const FeatureMatches> MatchesOf(int position1, int position2);
  std::vector<SecondCandidate> SecondCandidates(int first) const;  // best first
  double InterpairOverlap(int first, int candidate);
  Overlap AssessOverlap(int first);
  std::vector<PixelPair> SeedsFromMatches(int first, int second,
                                          const std::vector<SeaPointLabel>& labels);
  void AppendModelSeeds(int first, int second, std::vector<PixelPair>* seeds) const;
  PairReport NewReport(int first, int second, const std::string& pass) const;
  bool RunPair(int first, int second, const Overlap& overlap, std::vector<PixelPair> seeds,
               PairReport* report, PairResult* result);
  void ShowPair(int first, int second, const Overlap& overlap, const PairReport& report,
                PairInput input, const PairResult& result);

  const SparseModel& model_;
  const std::vector<int> order_;
  int num_track_ = 0;          // positions of the track; those behind it are right pictures
  std::vector<int> right_of_;  // position -> position of the simultaneous right picture, or -1
  const PartialDensificationOptions& options_;
  const int num_threads_;
  const SequenceCallbacks& callbacks_;
  PictureCache cache_;

  int previous_first_ = -1;
  ProcessedPicture previous_;  // of previous_first_
  std::vector<PackedFootprint> footprints_;
  GivenUp given_up_;                               // by the completion pass
  std::set<std::pair<int, int>> densified_pairs_;  // positions, smaller first
  std::vector<std::vector<int>> covisible_;  // position -> positions, most shared points first
  SequenceReport report_;
};

}  // namespace colmap_seapoint
