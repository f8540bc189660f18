// What is known of a model's size and place, as numbers: the input of EstimateSimilarity.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"

namespace colmap_seapoint {

struct PositionMeasurement {
  Eigen::Vector3d in_model;  // camera centre, model units
  Eigen::Vector3d metres;    // where it was measured
  // Standard deviation of each axis, metres; zero where unknown, so that the scatter itself tells.
  // Either all positions of a problem have one, or none has.
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

// A known length: of a scale bar, or between the two cameras of a rig.
struct LengthMeasurement {
  double in_model = 0;        // model units
  double in_model_sigma = 0;  // its standard deviation, model units
  double metres = 0;
  double sigma = 0.001;  // standard deviation of `metres`, metres
};

struct SimilarityProblem {
  std::vector<PositionMeasurement> positions;
  std::vector<LengthMeasurement> lengths;
  // Mean viewing direction of the cameras, in the model's frame; zero where they look all round.
  Eigen::Vector3d down_in_model = Eigen::Vector3d::Zero();
  int seed = 0;
  // Of the model before pictures came in, in the frame of `positions` (ours): kept where the
  // measurements allow it, so that what was made of the model stays true.
  std::optional<Similarity3d> former;
};

}  // namespace colmap_seapoint
