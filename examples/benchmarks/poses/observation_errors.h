// How far the observations of a model's points lie from where the survey's exact cameras see these
// points.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

inline constexpr std::array<double, 4> kErrorLimits = {0.25, 0.5, 1, 2};  // pixels

struct ErrorRow {
  std::string name;
  size_t num = 0;
  double median = 0;                                    // pixels
  std::array<double, kErrorLimits.size()> beyond = {};  // shares
};

struct ObservationErrors {
  size_t num_points = 0;    // of the model
  size_t num_unplaced = 0;  // no place that most of its observations agree on
  // All observations: the distance to the exact cameras' view of the point, which is triangulated
  // from them robustly; infinite for observations of unplaced points. Then pairs of observations of
  // one point, by how far apart in the sequence their pictures are: the Sampson distance.
  std::vector<ErrorRow> rows;
};

// Pictures are known by their names; those that the truth has not are passed over. The sequence is
// the order of the truth's pictures, strips of `images_per_strip`.
ObservationErrors MeasureObservations(const SparseModel& truth, const SparseModel& model,
                                      int images_per_strip);

std::string ErrorTable(const ObservationErrors& errors);

}  // namespace colmap_seapoint
