// Which of many measured positions agree with a model, and how well (ours). EstimateSimilarity
// starts here: gross outliers do no harm.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/georeference/similarity_problem.h"

namespace colmap_seapoint {

struct PositionConsensus {
  Similarity3d metric_from_model;
  std::vector<bool> is_inlier;
  // Standard deviation of the inliers' scatter, as a multiple of the given sigmas (of 1 m where
  // there are none).
  double sigma_factor = 1;
};

// The length of (model - measured), each axis in units of its sigma; in metres where sigma is
// unknown.
double NormalisedResidual(const PositionMeasurement& position, const Similarity3d& similarity);

// Largest normalised residual of an inlier, in units of sigma_factor: 99.7 % of the lengths of
// vectors of three normal numbers lie below.
inline constexpr double kMaxPositionResidual = 3.7;

// Least quantile of residuals (the h-th smallest, h = n/2 + 2) over minimal samples: all of them
// where they are few, else 3000 drawn with `seed`; then least squares over the positions within
// kMaxPositionResidual of the scatter. Fewer than 5 positions cannot say which of them is wrong:
// all count. With `down_in_model`, the positions lie on a line, about which any turn is possible:
// samples are of two, and of all turns the one is taken that brings `down_in_model` nearest to -z.
// nullopt when there are fewer than 3 positions (2 with `down_in_model`), and when no sample gives
// a similarity, as with all positions in one place. O(3000 n).
std::optional<PositionConsensus> FindPositionConsensus(
    const std::vector<PositionMeasurement>& positions,
    const std::optional<Eigen::Vector3d>& down_in_model, int seed);

// The similarity that takes the line from a to b in the model to the measured one, and of all turns
// about it the one that brings `down_in_model` nearest to -z. nullopt when the two ends coincide,
// when `down_in_model` lies along the line (within 12 degrees), or when the measured line is as
// steep.
std::optional<Similarity3d> LevelledSimilarity(const PositionMeasurement& a,
                                               const PositionMeasurement& b,
                                               const Eigen::Vector3d& down_in_model);

}  // namespace colmap_seapoint
