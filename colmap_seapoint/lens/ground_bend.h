// How the ground of a model is bent: what poses, relief, focal length and distortion trade among
// one another, and the larger a survey is the more.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// The plane of a model's ground, and the way of the survey on it.
struct GroundFrame {
  Eigen::Vector3d centre, along, across, up;  // along: the way of the camera centres
  double distance = 0;                        // median depth of points before the cameras
};

// nullopt for fewer than 3 pictures, or centres that all coincide.
std::optional<GroundFrame> FindGroundFrame(const SparseModel& model);

// By what each picture's centre is to be multiplied so that the sum is the curvature of their
// heights on the way along (half the second derivative; 1 / the model's unit), by least squares
// with an offset and slopes. Empty where fewer than 4 pictures leave that open.
std::vector<Eigen::Vector3d> CurvatureWeights(const SparseModel& model, const GroundFrame& frame);

// The curvature (as above) of heights over places.
double CurvatureOf(const std::vector<Eigen::Vector3d>& places, const Eigen::VectorXd& heights,
                   const GroundFrame& frame);

// The curvature of b's heights above a's, over the points that both have, on the way along, after
// the similarity that brings them nearest. 0 for fewer than 10 common points.
double CurvatureBetween(const SparseModel& a, const SparseModel& b, const GroundFrame& frame);

// The rise in the middle of a way that a curvature makes, in pixels there (GSD).
struct GroundBend {
  double near = 0;   // over five times the distance to the ground (10 metres at 2), at most `whole`
  double whole = 0;  // over the survey's own length: it grows with its square
};
GroundBend BendInGsd(double curvature, const SparseModel& model, const GroundFrame& frame);

}  // namespace colmap_seapoint
