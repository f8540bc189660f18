// Sparse points kept from the densifier, as a witness of its cloud where no truth is known.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "densify/partial_densification_options.h"
#include "examples/benchmarks/densify/densify_rows.h"

namespace colmap_seapoint {

struct HeldPoint {
  Eigen::Vector3f xyz;
  double gsd = 0;      // depth in its first view over the focal length there, model units
  double spacing = 0;  // between samples, in GSD
  double own_gsd =
      0;  // its own uncertainty in depth: reprojection error over tan(largest parallax)
};

struct HoldOut {
  SparseModel model;  // without the held points
  size_t num_held = 0;
  std::vector<HeldPoint> eligible;                     // of the held points
  std::map<int, std::vector<Eigen::Vector2d>> places;  // pixels where pictures saw the held points
};

// Takes every `every`-th point, in the order of their ids, out of the model. Eligible: three views
// or more, reprojection error up to a pixel.
HoldOut HoldOutPoints(const SparseModel& model, int every,
                      const PartialDensificationOptions& densification);

// Fills in near, passed, passed_near, passed_spacing, median_gsd, own_gsd and passed_sure.
void ScoreHoldOut(const std::vector<HeldPoint>& eligible, const std::vector<Eigen::Vector3f>& cloud,
                  HoldOutRow* row);

// Median over the points of their GSD as defined above; 0 when the model has no points.
double MedianGsd(const SparseModel& model);

}  // namespace colmap_seapoint
