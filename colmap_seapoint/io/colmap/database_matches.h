// Matches and two-view geometries of pairs of images in COLMAP's database.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "colmap_seapoint/base/features.h"
#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// A pair of image ids, smaller first.
using ImagePair = std::pair<uint32_t, uint32_t>;

// Whether `two_view_geometries` has a row for the pair. The row without inliers whose
// data are NULL does not count: COLMAP's own matchers write it for pictures that have stubs (as of
// an undefined geometry in 3.8 and 3.10, of a degenerate one in 4.2.1), and ours write empty data.
bool HasMatches(const ColmapDatabase& database, ImagePair pair);

// Both tables, in pair_id order: when id1 > id2 the match columns, F, E, H and the pose are
// swapped. Unset matrices are NULL. Replaces earlier rows of the pair.
void WriteMatches(ColmapDatabase* database, uint32_t image_id1, uint32_t image_id2,
                  const FeatureMatches& raw, const TwoViewGeometry& geometry);

// The pairs of which NoteMatching() was told something else; pairs that others have matched, or a
// version of ours that noted nothing, are not among them.
std::set<ImagePair> PairsMatchedOtherwise(const ColmapDatabase& database,
                                          const std::string& fingerprint);
// In a table of our own; to be called with the pair's WriteMatches().
void NoteMatching(ColmapDatabase* database, ImagePair pair, const std::string& fingerprint);

// Tables `matches` and `two_view_geometries` as stored: indices relate to (pair.first,
// pair.second). Empty when there is no row. Indices that no keypoint has are an Error. Matrices and
// poses that are NULL, empty or all zero are unset.
FeatureMatches ReadMatches(const ColmapDatabase& database, ImagePair pair);
TwoViewGeometry ReadTwoViewGeometry(const ColmapDatabase& database, ImagePair pair);

// The pairs with at least one verified match and both images in the database, by pair_id.
std::vector<ImagePair> ReadVerifiedPairs(const ColmapDatabase& database);

// The same of all pairs that were matched, with a verified match or without.
std::vector<ImagePair> ReadTriedPairs(const ColmapDatabase& database);

// Rows of both tables. For database_features.cc and database_loops.cc.
void DeleteMatchesOfImage(ColmapDatabase* database, uint32_t image_id);
void DeleteMatchesOfPair(ColmapDatabase* database, ImagePair pair);

}  // namespace colmap_seapoint
