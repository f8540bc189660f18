// What a map says of itself: map.json, the table of its pictures, and the lines on the terminal.
#pragma once

#include <string>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/orthomosaic/orthomosaic.h"
#include "colmap_seapoint/pipeline/orthomosaic/map_placement.h"

namespace colmap_seapoint {

// Holds no times and no paths: the same map has the same text.
std::string MapJson(const OrthomosaicSummary& map, const MapPlacement& placement,
                    const SparseModel& model);

// label,name,used: every picture of the model; "used" is 1 where a pixel's colour is from it.
std::string SourceTable(const OrthomosaicSummary& map, const SparseModel& model);

// "3.21 x 4.05 m in pixels of 1.53 mm, 98.9 % of the surface coloured, from 12 pictures; seen from
// above; north is up".
std::string MapLine(const OrthomosaicSummary& map, const MapPlacement& placement);

}  // namespace colmap_seapoint
