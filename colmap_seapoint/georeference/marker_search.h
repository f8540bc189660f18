// Which coded markers the tables ask for, and whether the pictures show them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "colmap_seapoint/georeference/scale_sources.h"
#include "colmap_seapoint/io/files/markers_csv.h"
#include "colmap_seapoint/markers/marker_name.h"

namespace colmap_seapoint {

// The coded markers that the bars' ends name, sorted. Throws Error for a bad table, and for a
// number that the family has not.
std::vector<MarkerName> MarkersOfBars(const ScaleSources& sources);

// Which markers have to be looked for in the pictures; empty: none.
std::vector<MarkerFamily> FamiliesToFind(const ScaleSources& sources);

// One line for each bar's marker that fewer than two pictures of all show, so that it is known
// before hours of mapping: "scale bars: tag36h11:12 is found in no picture; found: ...".
std::vector<std::string> MissingMarkers(const ScaleSources& sources,
                                        const std::vector<MarkerSighting>& sightings);

using MarkerCounts = std::map<MarkerName, size_t>;  // how often each was found

// "tag36h11:3, tag36h11:4": a few, those found most often first, since small families are found by
// chance too; "none" without any.
std::string MostFound(const MarkerCounts& counts);

}  // namespace colmap_seapoint
