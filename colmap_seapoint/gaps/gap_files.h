// gaps.geojson and gaps.csv.
#pragma once

#include <string>
#include <vector>

#include "colmap_seapoint/gaps/gap_places.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

// "top", "right:2": the layer's side, and its slab for all but the top.
std::string LayerName(const LayerKey& layer);
// The reverse; false for what is no such name.
bool ParseLayerName(const std::string& name, LayerKey* layer);

// A polygon a gap ("kind": "gap"), a line a pass ("pass"), and one for the route over all
// ("route"). Where the coordinates are not WGS84 the member "frame" says so, and "map_from_model"
// has the rows of the rotation. Outlines lie on the predicted surface: "surface": "predicted".
std::string GapsGeoJson(const CompletenessResult& result, const SparseModel& model,
                        const GapPlaces& places);

// A row a gap, in order of rank.
std::string GapsCsv(const CompletenessResult& result, const SparseModel& model,
                    const GapPlaces& places);

// All corners of all passes, in the order in which they are swum; world.
std::vector<Eigen::Vector3d> RouteCorners(const CompletenessResult& result);

}  // namespace colmap_seapoint
