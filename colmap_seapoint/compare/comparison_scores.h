// Accuracy, completeness and F-score of a comparison, in the three ways that the field counts them.
#pragma once

#include <cstddef>

#include "colmap_seapoint/compare/cloud_comparison.h"

namespace colmap_seapoint {

// Shares, 0 to 1. ETH3D calls f_score f1; Tanks and Temples say precision and recall.
struct ComparisonScores {
  double accuracy = 0;      // of the input's points
  double completeness = 0;  // of the reference's points
  double f_score = 0;       // their harmonic mean; 0 where both are
};

// At distances[k]. Needs at least one point (voxel) in either cloud, as every comparison has.
ComparisonScores PointScores(const CloudComparison& comparison, size_t k);  // kPointsDefinition
ComparisonScores Eth3dScores(const CloudComparison& comparison, size_t k);  // kEth3dDefinition
// kTanksAndTemplesDefinition
ComparisonScores TanksScores(const CloudComparison& comparison, size_t k);

}  // namespace colmap_seapoint
