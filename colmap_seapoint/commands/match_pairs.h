// What all matchers share: from a list of pairs to rows in the database.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/commands/run_options.h"
#include "colmap_seapoint/io/colmap_database.h"
#include "feature/match_features.h"

namespace colmap_seapoint {

// Images of the database that hold SeaPoints of ours; the others are left out. Throws Error when
// there is none.
std::vector<DatabaseImage> ImagesWithSeaPoints(const std::string& database_path,
                                               const ColmapDatabase& database, RunReport* report);

// Pairs that have a row are skipped: the same call again goes on where an earlier one stopped.
// What is written does not depend on num_threads.
void MatchPairs(const std::vector<ImagePair>& pairs, const SeaPointMatchingOptions& options,
                int num_threads, ColmapDatabase* database, RunReport* report);

}  // namespace colmap_seapoint
