// pairs.csv: one row a pair, in the order in which they were densified.
#pragma once

#include <filesystem>

#include "colmap_seapoint/base/sparse_model.h"
#include "densify/densify_sequence.h"

namespace colmap_seapoint {

// Atomic. Columns: image1, image2, pass, baseline (model units), overlap (0..1), num_oa, num_na,
// num_rea, num_seeds, num_failed_seeds, num_points, rectification_seconds, propagation_seconds,
// total_seconds, skipped (why; empty = it was densified).
void WritePairsCsv(const std::filesystem::path& path, const SparseModel& model,
                   const SequenceReport& report);

}  // namespace colmap_seapoint
