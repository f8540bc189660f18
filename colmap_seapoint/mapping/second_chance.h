// A second chance for pictures that nothing ties to the others (ours): a change of scale, as of an
// oblique camera that moves forward, defeats SeaPoints of one level. Such a picture and its
// neighbours in the sequence get SI-SeaPoints (paper 4); all others keep their own.
#pragma once

#include <set>
#include <string>

#include "colmap_seapoint/io/colmap/colmap_database.h"

namespace colmap_seapoint {

// The pictures without a pair of at least 30 verified matches (what the mapper needs to register a
// picture), and the ones before and after each of them in the order of their names. Pictures
// without SeaPoints do not count.
std::set<std::string> FindSecondChancePictures(const ColmapDatabase& database);

}  // namespace colmap_seapoint
