// A second chance for pictures that little ties to the others (ours). A change of scale, as between
// pictures of an oblique camera that moves forward, defeats SeaPoints of one level, and so does
// fine detail that is never the same twice (leaves, grass, ripples). Such a picture, and those that
// it was matched with, get SI-SeaPoints (paper 4) beside their own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// Pairs of at least 30 verified matches (what COLMAP's mapper asks for to register a picture) tie
// pictures into groups. Untied are the pictures outside the largest group (of equal ones, that of
// the smallest image id), but for those of groups of 20 pictures and more, which are dives of their
// own. Returns the names of the untied pictures and of all that a pair was tried with one of them,
// whatever came of it. Pictures without SeaPoints are passed over. Throws Error when the database
// cannot be read.
std::set<std::string> FindSecondChancePictures(const ColmapDatabase& database);

// How well all pictures hang together.
struct TieCount {
  size_t num_groups = 0;   // a picture without SeaPoints is a group of its own
  size_t num_between = 0;  // verified matches between pictures of different groups: too few to tie
};
TieCount CountTies(const ColmapDatabase& database);
// Whether more ties the pictures in `after`, be it not enough yet.
bool TiesMore(const TieCount& after, const TieCount& before);

// The group, named by the smallest id in it, of every picture with SeaPoints, by image_id.
std::map<uint32_t, uint32_t> TiedGroups(const ColmapDatabase& database);

}  // namespace colmap_seapoint
