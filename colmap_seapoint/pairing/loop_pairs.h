// Links beyond the next pictures (ours): pairs that look alike, wherever they stand in the
// sequence. They are found by retrieval over the SeaPoints themselves.
#pragma once

#include <vector>

#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"

namespace colmap_seapoint {

struct LoopSearch {
  int overlap = 0;     // that many successors are matched anyway
  int num_images = 0;  // candidates of a picture, at most
  RunOptions run;
};

// Pairs of `sequence` further apart than the overlap that are worth full matching: among each
// other's best candidates, and supported by the pairs around. Pairs that other matching has given a
// row are left out. The list is kept in the database: the same call again, on the same SeaPoints,
// reads it. Whatever the number of threads, the same pairs. Streams the SeaPoints three times;
// memory: 24 bytes a SeaPoint. About 10 ms a picture of 3000.
std::vector<ImagePair> FindLoopPairs(const std::vector<DatabaseImage>& sequence,
                                     const LoopSearch& search, ColmapDatabase* database);

}  // namespace colmap_seapoint
