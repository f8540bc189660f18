// What of the exact ground a cloud truly leaves uncovered, and why, by exact visibility.
#pragma once

#include <vector>

#include "densify/completeness/surface/gap_cause.h"
#include "examples/benchmarks/completeness/planted_gaps.h"

namespace colmap_seapoint {

struct TruthCell {
  bool is_expected = false, is_covered = false;
  GapCause cause = GapCause::kNone;
  double area = 0;      // m^2 along the surface
  bool is_gap = false;  // in a connected part, of one cause, above (10 spacings)^2
};

struct GapTruth {
  double min_x = 0, min_y = 0, side = 1;  // of the cells; ground's plan, metres
  int nx = 0, ny = 0;
  std::vector<TruthCell> cells;  // row by row

  TruthCell& At(int i, int j) {
    return cells[static_cast<size_t>(j) * static_cast<size_t>(nx) + static_cast<size_t>(i)];
  }
  const TruthCell& At(int i, int j) const { return const_cast<GapTruth*>(this)->At(i, j); }
  Eigen::Vector2d Place(int i, int j) const {
    return {min_x + (i + 0.5) * side, min_y + (j + 0.5) * side};
  }
};

// `truth`: all pictures of the survey; `points`: the cloud in its frame; `step`: pixels a point. A
// place is covered when a point lies within two GSD (or one and a half spacings) of it: of those of
// the two pictures that measure it best, where these are coarser than the survey's own. Expected is
// what a picture sees that was taken, or would have been (the removed ones), but for background:
// what no two see from two sides, and all see at twice the survey's own GSD or more, and what lies
// beyond the limit of sight, as completeness_reporter defines it, by exact visibility.
GapTruth MeasureGapTruth(const SurveyTruth& truth, const PlantedGaps& gaps, double spacing,
                         double step, const std::vector<Eigen::Vector3f>& points, int num_threads);

}  // namespace colmap_seapoint
