// The least-squares problem behind EstimateSimilarity. For estimate_similarity.cc only.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/georeference/similarity_problem.h"

namespace colmap_seapoint {

// What is being estimated, and from what.
struct EstimationState {
  const SimilarityProblem& problem;
  // Level and across the line of the positions, metric axes; only where the line is levelled.
  std::optional<Eigen::Vector3d> across;
  double position_factor = 1, length_factor = 1;
  std::vector<bool> position_used, length_used;
  bool has_positions = false;
};

// Standard deviation of the length's residual, metres, by the length's own and the model's
// uncertainty; never zero.
double LengthSigma(const LengthMeasurement& length, double scale);
// Standard deviation of each axis of a position, metres.
Eigen::Vector3d PositionSigma(const EstimationState& state, const PositionMeasurement& position);

// The mean of the used positions, model units.
Eigen::Vector3d PivotOf(const EstimationState& state);

struct SimilaritySolution {
  Similarity3d similarity;
  double cost = std::numeric_limits<double>::infinity();
  double scale_sigma = 0;
  double rotation_sigma_deg = 0;
};

// Least squares over the used measurements (and the levelling, where state.across is set) from
// `start`; `is_robust`: with Cauchy's loss, and without standard deviations.
SimilaritySolution SolveSimilarity(const EstimationState& state, const Similarity3d& start,
                                   bool is_robust);

}  // namespace colmap_seapoint
