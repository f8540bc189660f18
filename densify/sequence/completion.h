// The completion pass (ours): after the sequence, what two pictures of any strip see and no pair
// has covered is densified from the best pair for it. Most of it is the rim of the survey, which
// only (V, V + 2) or neighbouring strips see twice.
#pragma once

#include <array>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "densify/match/cell_grid.h"
#include "densify/match/view.h"
#include "densify/overlap/coverage.h"

namespace colmap_seapoint {

struct CompletionCandidate {
  int position;
  View view;
};

// How often the completion pass tries a surface, from whatever pictures.
inline constexpr size_t kMaxTries = 4;

// Surface that completion pairs were to cover and could not: hidden, too steep, without texture.
struct GivenUp {
  // after[k]: after k + 1 tries.
  std::array<std::vector<PackedFootprint>, kMaxTries> after;
};

// A picture as the completion pass sees it, cell by cell.
struct CompletionView {
  ViewCoverage coverage;
  std::vector<double> predicted_range;  // PredictRanges
  std::vector<uint8_t> tries;           // how often its surface was tried in vain, 0 .. kMaxTries
  std::vector<double> admissible = {};  // AdmissibleUncertainty; empty: any will do
};

// All of it but the predicted ranges and what is admissible.
CompletionView LookAt(const View& view, const CellGrid& cells,
                      const std::vector<PackedFootprint>& footprints, const GivenUp& given_up);

// The pair that completes most, and the cells it is to leave alone: all others than those it is
// for.
struct CompletionTarget {
  int partner = -1;  // position
  std::vector<uint8_t> closed;
};

// The candidate that measures most of the picture's uncovered cells, at their predicted ranges
// (ViewQuality; any angle from 2 to 60 degrees counts for something); none when that is less than
// kMinGain of the picture. Cells that were tried are worth no pair of their own, but are tried
// again along with others, kMaxTries times in all.
CompletionTarget SelectCompletionPartner(const View& view, const CompletionView& seen,
                                         const std::vector<CompletionCandidate>& candidates);

// Growth goes on where it once stopped: a seed in every uncovered cell that touches a covered one,
// at its predicted range.
std::vector<PixelPair> SeedsAlongRim(const View& view, const View& partner,
                                     const CompletionView& seen);

// After the pair: `filled` (empty: nothing) tells which of the target's cells it failed to cover.
void NoteFailures(const View& view, const CompletionTarget& target,
                  const std::vector<float>& filled, CompletionView* seen, GivenUp* given_up);

}  // namespace colmap_seapoint
