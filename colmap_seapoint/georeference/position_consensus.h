// Which of many measured positions agree with a model, and how well (ours): the start of
// EstimateSimilarity, safe from gross outliers.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"

namespace colmap_seapoint {

struct PositionMeasurement {
  Eigen::Vector3d in_model;  // camera centre, model units
  Eigen::Vector3d metres;    // where it was measured
  // Standard deviation of each axis, metres; zero: unknown, the scatter itself tells. All positions
  // of a problem alike.
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

struct PositionConsensus {
  Similarity3d metric_from_model;
  std::vector<bool> is_inlier;
  // Standard deviation of the measurements over the given sigmas (over 1 m where there are none),
  // from the inliers' scatter.
  double sigma_factor = 1;
};

// Normalised residual: the length of (model - measured) in units of sigma, metres where unknown.
double NormalisedResidual(const PositionMeasurement& position, const Similarity3d& similarity);

// Largest normalised residual of an inlier, in units of sigma_factor: 3 axes, 99.7 %.
inline constexpr double kMaxPositionResidual = 3.7;

// Least median (rather: quantile of h = n/2 + 2) of residuals over minimal samples, all of them
// where that is cheap, else 3000 drawn with `seed`; then least squares over those within
// kMaxPositionResidual of the scatter. Fewer than 5 positions cannot say which of them is wrong:
// all count. With `down_in_model`, the positions lie on a line, about which any turn is possible:
// samples are of two, and of all turns the one is taken that brings `down_in_model` nearest to -z.
// nullopt when no sample gives a similarity (all positions in one place). Needs 3 positions; 2 with
// `down_in_model`. O(3000 n).
std::optional<PositionConsensus> FindPositionConsensus(
    const std::vector<PositionMeasurement>& positions,
    const std::optional<Eigen::Vector3d>& down_in_model, int seed);

// The similarity between the two lines through a and b that brings `down` nearest to -z; nullopt
// when a pair coincides, or `down` lies along the line.
std::optional<Similarity3d> LevelledSimilarity(const PositionMeasurement& a,
                                               const PositionMeasurement& b,
                                               const Eigen::Vector3d& down_in_model);

}  // namespace colmap_seapoint
