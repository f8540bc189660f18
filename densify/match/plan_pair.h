// What a pair has to do (paper 2.6, first box of Figure 14): which cells of picture 1 are new,
// which seeds lie in them, and which windows of the rectified frame hold all that may be matched.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/base/image.h"
#include "colmap_seapoint/base/picture.h"
#include "densify/match/cell_grid.h"
#include "densify/match/densification_mode.h"
#include "densify/match/rectification.h"
#include "densify/match/sample_grid.h"
#include "densify/match/view.h"

namespace colmap_seapoint {

// One pair as it comes from the sequence. The pictures are lent.
struct PairInput {
  View view1, view2;
  const Picture* picture1 = nullptr;
  const GrayImage* luma2 = nullptr;
  const GrayImage* mask2 = nullptr;  // as Picture::mask; none: empty or nullptr
  std::vector<FurtherView> further;  // others that show the same; maybe none
  std::vector<PixelPair> seeds;
  KnownCells known;  // of picture 1; in kComplete it only tells which part of the result is new
  DensificationMode mode = DensificationMode::kPartial;
};

struct MatchOptions {
  int step;              // pixels between samples
  int window_size;       // correlation window, pixels, odd
  float min_zncc;        // smallest correlation of a match
  double max_expansion;  // how far matches spread from a seed, share of picture 1's longer side
  float min_confidence;  // of what goes into the cloud
};

// Disparities that are looked for, both inclusive, rect pixels.
struct DisparityRange {
  int min = 0, max = 0;
};

struct PairPlan {
  std::string failure;  // why there is nothing to do, or empty; then the rest is unset
  PairGeometry geometry;
  KnownCells avoided;               // not to be matched again
  std::vector<Seed> seeds;          // the usable ones
  std::vector<Seed> covered_seeds;  // those of them that stand out from a covered cell's surface
  DisparityRange disparities;
  double growth = 0;  // how far matches may spread from a seed, pixels
  int node_step = 0;  // pixels
  int margin = 0;     // pixels that the windows of an open place's matches need around it
  RectWindow window1, window2;
};

// What covers a cell, as disparities at the rect position (x, y).
CoveredBand CoveredAt(const PairGeometry& geometry, const KnownCells& known, size_t cell, double x,
                      double y);

// Ordinary failures: the cameras coincide, there are fewer than five usable seeds, or
// the pictures do not overlap. Cost: O(cells + seeds).
PairPlan PlanPair(const PairInput& input, const MatchOptions& options);

}  // namespace colmap_seapoint
