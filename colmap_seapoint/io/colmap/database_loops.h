// The pairs that loop detection chose, and what it chose them from (`fingerprint`): a table of our
// own in COLMAP's database, so that a run that was interrupted goes on with the same pairs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_matches.h"

namespace colmap_seapoint {

// nullopt when the pairs were chosen from something else, or never. A damaged list is an Error.
std::optional<std::vector<ImagePair>> ReadLoopPairs(const ColmapDatabase& database,
                                                    const std::string& fingerprint);
// Whatever their fingerprint; empty when there are none.
std::vector<ImagePair> ReadLoopPairs(const ColmapDatabase& database);

// Replaces the list. Matches and two-view geometries of pairs that only the old list had are
// dropped: a run from the start would not have them.
void WriteLoopPairs(ColmapDatabase* database, const std::string& fingerprint,
                    const std::vector<ImagePair>& pairs);

}  // namespace colmap_seapoint
