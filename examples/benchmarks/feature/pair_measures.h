// What the feature benchmark measures on a pair of pictures without knowing the truth.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/base/image.h"
#include "densify/match/cell_grid.h"
#include "densify/overlap/influence_mask.h"

namespace colmap_seapoint {

// NaN values (nothing to measure) do not count; NaN when no other is left. The mean of the two
// middle ones for an even number.
double Median(std::vector<double> values);

// Over the smaller number of points of the two pictures; 0 when one has none.
double MatchedShare(size_t num_matches, size_t num_points1, size_t num_points2);

// Influence areas (paper 2.5) around the matched points of picture 2, as if all of picture 1 had
// been processed (label PA). `grid`: of picture 2; `radius`: pixels.
InfluenceMask MatchedArea(const CellGrid& grid, size_t num_points1,
                          const std::vector<SeaPoint>& points2, const FeatureMatches& matches,
                          double radius);

// A picture's cells in which something can be seen.
struct Texture {
  double noise = 0;               // standard deviation, grey levels
  double limit = 0;               // grey levels
  std::vector<uint8_t> textured;  // by cell: standard deviation of its grey levels > limit
};

// The noise is that of the flattest cells: the 5th percentile over all cells of Immerkaer's
// estimate (mean absolute response to the difference of two Laplacians). The limit is three times
// that, and at least 1.5 grey levels (three times the coarsest rounding).
Texture FindTexture(const GrayImage& picture, const CellGrid& grid);

}  // namespace colmap_seapoint
