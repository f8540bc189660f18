// A second chance for pictures that nothing ties to the others (ours). A change of scale, as
// between pictures of an oblique camera that moves forward, defeats SeaPoints of one level. Such a
// picture and its neighbours in the sequence get SI-SeaPoints (paper 4); all others keep their own.
#pragma once

#include <set>
#include <string>

#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// Names of the pictures without a pair of at least 30 verified matches (what COLMAP's mapper asks
// for to register a picture), and of the ones before and after each of them in the natural order of
// names. Pictures without SeaPoints are passed over. Throws Error when the database cannot be read.
std::set<std::string> FindSecondChancePictures(const ColmapDatabase& database);

}  // namespace colmap_seapoint
