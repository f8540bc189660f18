// pairs.csv: one row a pair, in the order in which they were densified.
#pragma once

#include <filesystem>
#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "densify/densify_sequence.h"

namespace colmap_seapoint {

// Atomic. Columns: image1, image2, pass, baseline (model units), overlap (0..1), num_oa, num_na,
// num_rea, num_seeds, num_failed_seeds, num_points, rectification_seconds, propagation_seconds,
// total_seconds, skipped (why; empty = it was densified).
// `earlier_rows`: those of the run that is continued, as they stand.
void WritePairsCsv(const std::filesystem::path& path, const SparseModel& model,
                   const SequenceReport& report, const std::string& earlier_rows = "");

// All rows of such a file, without its header. Throws Error when it cannot be read.
std::string RowsOfPairsCsv(const std::filesystem::path& path);

}  // namespace colmap_seapoint
