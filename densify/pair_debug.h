// What the paper's figures show of one pair (10, 11, 13, 15, 17), lent to whoever draws them.
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/picture.h"
#include "densify/match/cell_grid.h"
#include "densify/match/view.h"
#include "densify/overlap/influence_mask.h"
#include "densify/sequence_report.h"

namespace colmap_seapoint {

struct PairResult;

// Valid during the call that hands it over. "Previous" is the first picture of the pair before (V
// of the paper; picture 1 of this pair is V + 2).
struct PairDebug {
  PairReport report;
  View view1, view2;
  const Picture* picture1 = nullptr;
  const std::vector<SeaPoint>* points1 = nullptr;
  std::vector<SeaPointLabel> labels1;  // empty: no labels (completion pass)

  // Interpair (paper 2.5). Without a previous pair all of it is unset.
  int previous_image_idx = -1;
  const Picture* previous_picture = nullptr;
  const std::vector<SeaPoint>* previous_points = nullptr;
  std::vector<SeaPointLabel> previous_labels;
  FeatureMatches interpair;      // idx1 in previous_points, idx2 in points1
  InfluenceMask mask;            // on picture 1
  double influence_radius1 = 0;  // pixels of picture 1
  double influence_radius0 = 0;  // pixels of the previous picture

  KnownCells known;  // of picture 1; covered ranges: redundancy "all" (ours)

  const PairResult* partial = nullptr;
  const PairResult* normal = nullptr;  // what the pair gives when nothing counts as done before
  // Pixels of picture 1: the seeds in new areas whose own cell holds less than a tenth of its
  // disparities.
  std::vector<Eigen::Vector2d> failed_seeds;
};

}  // namespace colmap_seapoint
