// What came before, as the next pair has to know it (paper 2.5 and 2.7): against the previous pair
// (the paper's), and against every earlier view of the same place (ours).
#pragma once

#include <vector>

#include "colmap_seapoint/base/features.h"
#include "densify/match/cell_grid.h"
#include "densify/overlap/coverage.h"
#include "densify/overlap/influence_mask.h"

namespace colmap_seapoint {

struct PairOverlap {
  InfluenceMask mask;                 // with the previous pair; no cells when there is none
  KnownCells known;                   // of the pair's first picture
  std::vector<SeaPointLabel> labels;  // of the first picture's SeaPoints; empty: not labelled
  double rate = 0;                    // share of the first picture, 0..1
};

// The first pair of all: every SeaPoint lies in a new area.
PairOverlap WithoutPrevious(const CellGrid& cells, const std::vector<SeaPoint>& points);

// Paper: what the mask marks is closed. `mask` is MakeInfluenceMask's, from the same arguments.
PairOverlap OverlapWithPrevious(InfluenceMask mask, const std::vector<SeaPoint>& points,
                                const FeatureMatches& matches, const ProcessedPicture& previous,
                                double radius);

// Ours: the poses tell what is known, wherever and whenever it was seen; nothing is closed, what
// differs from the known surface may be new. SeaPoints on known surface are OA; those that only the
// matches took for known are REA.
PairOverlap OverlapWithAll(PairOverlap overlap, const ViewCoverage& coverage,
                           const std::vector<SeaPoint>& points);

}  // namespace colmap_seapoint
