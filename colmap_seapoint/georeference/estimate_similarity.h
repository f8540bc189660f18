// From measurements to the similarity that takes a model into metres (ours; the paper leaves scale
// to COLMAP).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/georeference/position_consensus.h"

namespace colmap_seapoint {

// Raise it whenever the same measurements give another similarity than before.
inline constexpr char kScalingVersion[] = "1";

// A scale bar, or the spacing of a rig's cameras.
struct LengthMeasurement {
  double in_model = 0;        // model units
  double in_model_sigma = 0;  // its standard deviation, model units
  double metres = 0;
  double sigma = 0.001;  // metres
};

struct SimilarityProblem {
  std::vector<PositionMeasurement> positions;
  std::vector<LengthMeasurement> lengths;
  // Mean viewing direction of the cameras, model's frame; zero: they look all round.
  Eigen::Vector3d down_in_model = Eigen::Vector3d::Zero();
  int seed = 0;
};

struct SimilarityEstimate {
  std::string problem;  // why there is none; empty: there is one
  std::vector<std::string> warnings;
  Similarity3d metric_from_model;
  double scale_sigma = 0;  // standard deviation of the scale, metres a model unit
  // False: rotation and translation are the model's own (no usable positions).
  bool has_frame = false;
  // The turn about the line of the positions, which they do not tell, is the one that brings the
  // mean viewing direction into the vertical plane of the line.
  bool is_levelled = false;
  double rotation_sigma_deg = 0;  // of the least certain turn

  // Model minus measured, metres, for every measurement; and whether it was used.
  std::vector<Eigen::Vector3d> position_residuals;
  std::vector<double> length_residuals;
  std::vector<bool> position_used, length_used;
  // Standard deviation taken for every axis of a position, metres (its own times sigma_factor).
  std::vector<Eigen::Vector3d> position_sigmas;
  std::vector<double> length_sigmas;
  double position_rms = 0, length_rms = 0;  // of the used ones, metres
};

// All sources at once. Starts: the consensus of the positions, and that with the scale that most
// lengths agree on. From each, least squares with Cauchy's loss (Ceres; scale, rotation,
// translation); the better one goes on with the measurements within 3.7 sigma (3.3: lengths), which
// are chosen anew until nothing changes. Sigmas that are not given, or that the scatter shows to
// be too small, come from the scatter. With lengths alone, the frame stays the model's and only the
// scale is estimated; with fewer than 3 positions these are passed over, with a warning. Outliers
// are told from 5 positions, or 3 lengths, on. One thread; the same bytes every time; milliseconds
// to a second for 10,000 positions.
SimilarityEstimate EstimateSimilarity(const SimilarityProblem& problem);

}  // namespace colmap_seapoint
