// The observations of a model measured again in the pictures, and those that matching missed
// (ours).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"

namespace colmap_seapoint {

// That an adjustment takes in: its memory grows with them.
inline constexpr size_t kMaxAdjustedObservations = 1600000;

struct MeasuringJob {
  std::filesystem::path image_path;
  std::string mask_path;  // COLMAP's masks (picture_masks.h); empty = none
  int num_threads = 1;    // -1 = all; never changes a result
};

// Extends the tracks (remeasuring/extend_tracks.h) and measures all observations again
// (remeasuring/remeasure_observations.h): those that are known best where they are enough to hold
// each picture, else those that are known at all. Where neither are, the model stays as it is.
// `num_points2D`: NumPoints2D(*model), for DropExtensions() afterwards.
void ExtendAndMeasure(const MeasuringJob& job, const std::map<uint32_t, size_t>& num_points2D,
                      SparseModel* model);

}  // namespace colmap_seapoint
