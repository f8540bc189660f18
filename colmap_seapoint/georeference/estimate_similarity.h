// From measurements to the similarity that takes a model into metres (ours; the paper leaves scale
// to COLMAP).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "colmap_seapoint/base/similarity3.h"
#include "colmap_seapoint/georeference/similarity_problem.h"

namespace colmap_seapoint {

// Raise it whenever the same measurements give another similarity than before
// (tests/georeference/scaling_version_test.cc watches).
inline constexpr char kScalingVersion[] = "1";

struct SimilarityEstimate {
  std::string problem;  // why there is no estimate; empty: there is one
  std::vector<std::string> warnings;
  Similarity3d metric_from_model;
  double scale_sigma = 0;  // standard deviation of the scale, metres a model unit
  // False where there are no usable positions: rotation and translation are then the model's own.
  bool has_frame = false;
  // True where problem.former is kept: it is metric_from_model then, and the residuals are its.
  bool is_former = false;
  // True where the positions do not tell the turn about their line: it is then the one that brings
  // the mean viewing direction into the vertical plane of the line.
  bool is_levelled = false;
  double rotation_sigma_deg = 0;  // of the least certain turn

  // One a measurement, in the order of the problem: model minus measured, metres, and whether it
  // was used.
  std::vector<Eigen::Vector3d> position_residuals;
  std::vector<double> length_residuals;
  std::vector<bool> position_used, length_used;
  // The standard deviations that were taken, metres, one for every axis of a position: the given
  // ones times the factor that the scatter asks for.
  std::vector<Eigen::Vector3d> position_sigmas;
  std::vector<double> length_sigmas;
  double position_rms = 0, length_rms = 0;  // of the used ones, metres
};

// All sources at once. There are two starts: the consensus of the positions, and the same with the
// scale that most lengths agree on. From each, least squares with Cauchy's loss (Ceres; scale,
// rotation, translation); the better one goes on with the measurements within 3.7 sigma (lengths:
// 3.3), which are chosen anew until nothing changes. Sigmas that are not given, or that the scatter
// shows to be too small, come from the scatter. With lengths alone, the frame stays the model's and
// only the scale is estimated; fewer than 3 positions are passed over, with a warning. Outliers can
// be told from 5 positions, or 3 lengths, on. What cannot be solved is a `problem` in the result,
// never an exception. The former similarity is kept where it brings no position farther from where
// the new one does than twice what their mean is uncertain by (the scatter of the used ones over
// the root of their number), and the scale no farther than its standard deviation. One thread; the
// same bytes every time; milliseconds, or up to a second for 10,000 positions.
SimilarityEstimate EstimateSimilarity(const SimilarityProblem& problem);

}  // namespace colmap_seapoint
