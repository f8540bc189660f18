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
// What is written does not depend on num_threads. A pair counts as verified only when at least
// `min_inlier_share` of its matches are inliers.
void MatchPairs(const std::vector<ImagePair>& pairs, const SeaPointMatchingOptions& options,
                double min_inlier_share, int num_threads, ColmapDatabase* database,
                RunReport* report);

// What pairs that need not overlap must show to count as verified, beyond the user's options.
SeaPointMatchingOptions DemandingOptions(const SeaPointMatchingOptions& options);
inline constexpr double kDemandingInlierShare = 0.5;

// A picture that no other one matches is lost for the mapper: says so, after all pairs are matched.
void WarnOfLonelyImages(const ColmapDatabase& database, const std::vector<DatabaseImage>& images);

}  // namespace colmap_seapoint
