// What of the exact ground a cloud truly leaves uncovered, and why, by exact visibility.
#pragma once

#include <vector>

#include "densify/completeness/surface/gap_cause.h"
#include "examples/benchmarks/completeness/planted_gaps.h"

namespace colmap_seapoint {

struct TruthCell {
  // Whether a report that gives this cause is right.
  bool IsRight(GapCause said) const {
    const bool is_either = said == GapCause::kNoTexture && cause == GapCause::kViewsDisagree;
    return said == cause || (is_either && !is_planted);
  }

  bool is_expected = false, is_covered = false;
  // Where two good pictures see it from two sides: kNoTexture or kViewsDisagree where that was
  // planted, and elsewhere kViewsDisagree, which stands for both: why nothing could be matched
  // there the generator does not know.
  GapCause cause = GapCause::kNone;
  bool is_planted = false;
  double area = 0;      // m^2 along the surface
  bool is_gap = false;  // in a connected part, of one cause, above (10 spacings)^2
};

struct GapTruth {
  // The survey's own: median over what its pictures can give, metres a pixel; and times the step of
  // its samples.
  double survey_gsd = 0, spacing = 0;
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

// By the exact surface and cameras alone; of completeness_reporter's answer nothing is known here.
// `truth`: all pictures of the survey; `points`: the cloud's sure ones, in
// its frame. A place is covered when a
// point lies within two GSD (or one and a half spacings) of it: of the survey's own, or those of
// the two pictures that measure it best where these are coarser. Expected is what is covered, and
// what a picture that was taken, or would have been (the lost and the removed ones), holds at twice
// the survey's own GSD or less; what all see from farther away is background.
GapTruth MeasureGapTruth(const SurveyTruth& truth, const PlantedGaps& gaps,
                         const std::vector<Eigen::Vector3f>& points, int num_threads);

}  // namespace colmap_seapoint
