// Where a model's cameras were, from what lies beside the pictures or in them: a navigation log,
// or GPS and depth in EXIF.
#pragma once

#include <string>

#include "colmap_seapoint/georeference/scale_measurements.h"
#include "colmap_seapoint/pictures/exif_positions.h"

namespace colmap_seapoint {

struct PositionSource {
  // Whether there is any: else the user has given others, declined, or the pictures tell nothing.
  bool is_there = false;
  // Why it gives nothing for this model, for a diver; empty: it does. It is never a reason to stop.
  std::string problem;
  MeasuredPositions measured;
  std::string text;  // where it is from and what was found, for a diver
};

// The log where one is given; else EXIF where no other source is. Throws Error for a log that
// cannot be read.
PositionSource FindPositions(const ScaleSources& sources, const PictureRecords& records,
                             const SparseModel& model);

// Why positions that nobody has vouched for are not to be trusted with a model's scale; "" when
// they are.
std::string Doubt(const SimilarityEstimate& estimate);

}  // namespace colmap_seapoint
