// Puts measurements into a model: observations are moved or taken out, tracks follow.
#pragma once

#include <vector>

#include "colmap_seapoint/remeasuring/measurement.h"
#include "colmap_seapoint/remeasuring/remeasure_observations.h"

namespace colmap_seapoint {

// `measured`: by image_idx. Points whose track has fewer than two observations left go, and with
// them what observes them. `of_other_size` stays empty.
Remeasurement ApplyMeasurements(const SparseModel& model,
                                const std::vector<ImageMeasurements>& measured);

}  // namespace colmap_seapoint
