// What all matchers share: from a list of pairs to rows in the database.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/base/run_options.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"
#include "colmap_seapoint/io/colmap/database_images.h"
#include "colmap_seapoint/io/colmap/database_matches.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "feature/match_features.h"

namespace colmap_seapoint {

// Images of the database that hold SeaPoints of ours; the others are left out. Throws Error when
// there is none.
std::vector<DatabaseImage> ImagesWithSeaPoints(const std::string& database_path,
                                               const ColmapDatabase& database, RunReport* report);

// Pairs that have a row are skipped: the same call again goes on where an earlier one stopped. Not
// so those that MatchPairs() has matched with other `asked`, the user's options: they are matched
// again. What others have matched stays.
// What is written does not depend on num_threads. A pair counts as verified only when its
// inliers' OverlapShare is at least `min_overlap_share`.
void MatchPairs(const std::vector<ImagePair>& pairs, const SeaPointMatchingOptions& options,
                const std::string& asked, double min_overlap_share, int num_threads,
                ColmapDatabase* database, RunReport* report);

// The same, but with at least 30 inliers: for pairs by the thousand that were chosen for looking
// alike.
SeaPointMatchingOptions DemandingOptions(const SeaPointMatchingOptions& options);

// A picture that no other one matches is lost for the mapper: says so, after all pairs are matched.
void WarnOfLonelyImages(const ColmapDatabase& database, const std::vector<DatabaseImage>& images);

}  // namespace colmap_seapoint
