// A copy of a COLMAP database with fewer matches, for a mapper to grow poses from (ours).
#pragma once

#include <cstdint>
#include <filesystem>

#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

struct ThinningOptions {
  int observations_per_picture = 256;  // about; see choose_tracks.h
  // A pair keeps at least so many of its matches, or all: what ties strips together may be few.
  int min_matches_per_pair = 40;
};

struct Thinning {
  int64_t num_matches = 0;         // verified, of the database
  int64_t num_chosen_matches = 0;  // of the copy
};

// Writes `copy`, replacing what is there: all of the database that CopyDatabase takes (so that
// pictures and keypoints have the same numbers), but of each pair's verified matches only those
// between observations of chosen tracks. Throws Error. Memory: about 40 bytes a keypoint. About 1
// microsecond a match.
Thinning WriteThinnedDatabase(const ColmapDatabase& database, const ThinningOptions& options,
                              const std::filesystem::path& copy);

}  // namespace colmap_seapoint
