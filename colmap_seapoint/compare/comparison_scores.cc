#include "colmap_seapoint/compare/comparison_scores.h"

#include <cstdint>

namespace colmap_seapoint {
namespace {

double Share(uint64_t part, uint64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

double HarmonicMean(double a, double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }

ComparisonScores Scores(double of_input, double of_reference) {
  return {of_input, of_reference, HarmonicMean(of_input, of_reference)};
}

}  // namespace

ComparisonScores PointScores(const CloudComparison& c, size_t k) {
  return Scores(Share(c.input.at[k].num_within, c.input.num_points),
                Share(c.reference.at[k].num_within, c.reference.num_points));
}

ComparisonScores Eth3dScores(const CloudComparison& c, size_t k) {
  return Scores(c.input.at[k].voxel_share, c.reference.at[k].voxel_share);
}

ComparisonScores TanksScores(const CloudComparison& c, size_t k) {
  const DistanceShares& input = c.input.at[k];
  const DistanceShares& reference = c.reference.at[k];
  return Scores(Share(input.num_reduced_within, input.num_reduced),
                Share(reference.num_reduced_within, reference.num_reduced));
}

}  // namespace colmap_seapoint
