// The completion pass (ours): after the sequence, what two pictures of any strip see and no pair
// has covered is densified from the best pair for it. Most of it is the rim of the survey, which
// only (V, V + 2) or neighbouring strips see twice.
#pragma once

#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "densify/coverage.h"
#include "densify/densify_pair.h"

namespace colmap_seapoint {

// For every position, the positions that share triangulated points with it, most shared first, ties
// by position; at most 12. O(track elements squared per point).
std::vector<std::vector<int>> CovisiblePictures(const SparseModel& model,
                                                const std::vector<int>& order);

// Median angle between the rays of the points that both pictures see, degrees; 0 when they share
// none.
double MedianParallaxDeg(const SparseModel& model, const PosedImage& image1,
                         const PosedImage& image2);

struct CompletionCandidate {
  int position;
  View view;
};

// Range of the surface in every cell of the picture: what is reconstructed there, and elsewhere
// that of the nearest cell that is reconstructed or holds a triangulated point. All 0 when there is
// neither. (The mapper drops points that only two pictures see, so the rim, which matters most
// here, has none of its own.)
std::vector<double> PredictRanges(const SparseModel& model, const PosedImage& image,
                                  const View& view, const ViewCoverage& coverage);

// The candidate that sees most of the picture's uncovered cells, at their predicted ranges, with a
// baseline that can measure depth; its position, or -1 when none sees more than kMinGain of the
// picture.
int SelectCompletionPartner(const View& view, const ViewCoverage& coverage,
                            const std::vector<double>& predicted_range,
                            const std::vector<CompletionCandidate>& candidates);

// Growth goes on where it once stopped: a seed in every uncovered cell that touches a covered one,
// at its predicted range.
std::vector<PixelPair> SeedsAlongRim(const View& view, const View& partner,
                                     const ViewCoverage& coverage,
                                     const std::vector<double>& predicted_range);

}  // namespace colmap_seapoint
