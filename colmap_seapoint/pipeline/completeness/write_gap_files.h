// The report for other programs: tables, maps, and what vehicles and map programs take in.
#pragma once

#include <vector>

#include "colmap_seapoint/base/sparse_model.h"
#include "colmap_seapoint/gaps/former_report.h"
#include "colmap_seapoint/gaps/gap_changes.h"
#include "colmap_seapoint/gaps/gap_places.h"
#include "colmap_seapoint/io/outputs/output_folder.h"
#include "densify/completeness/assess_completeness.h"

namespace colmap_seapoint {

inline constexpr char kCompletenessFile[] = "completeness.json";

struct GapFilesInput {
  const SparseModel& model;
  const CompletenessResult& result;
  const GapPlaces& places;
  const std::vector<GapChange>& changes;  // since the report before
};

// gaps.geojson, gaps.csv, map.png, kCompletenessFile, which `folder` has claimed; and what only
// some results have: map_<layer>.png of other layers with gaps, and where georeferenced gaps.kml
// and route.plan, .waypoints and .cmp. What an earlier run left of these is removed. Throws Error.
void WriteGapFiles(const GapFilesInput& input, OutputFolder* folder);

}  // namespace colmap_seapoint
