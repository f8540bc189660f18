#include "colmap_seapoint/pipeline/completeness/write_gap_files.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

#include "colmap_seapoint/gaps/completeness_json.h"
#include "colmap_seapoint/gaps/gap_files.h"
#include "colmap_seapoint/gaps/gap_kml.h"
#include "colmap_seapoint/gaps/gap_map.h"
#include "colmap_seapoint/gaps/route_files.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/image/image_file.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

// Of the layers with gaps, but for the top, which is always drawn.
std::set<LayerKey> LayersWithGaps(const CompletenessResult& result) {
  std::set<LayerKey> layers;
  for (const Gap& gap : result.gaps) layers.insert(gap.region.layer);
  layers.erase({Side::kTop, 0});
  return layers;
}

std::string MapName(const LayerKey& layer) {
  std::string name = "map_" + LayerName(layer) + ".png";
  std::replace(name.begin(), name.end(), ':', '_');
  return name;
}

// Where the model is georeferenced; else those of an earlier run go, as does a route without gaps.
void WriteGeographic(const CompletenessResult& result, const GapPlaces& places,
                     OutputFolder* folder) {
  const auto write = [&](const std::string& name, bool is_wanted, const auto& text) {
    if (is_wanted) {
      folder->Claim({name});
      WriteTextFile(folder->Path() / name, text(result, places));
    } else if (folder->IsOurs(name)) {
      folder->Remove(name);
    }
  };
  const bool has_route = places.IsGeographic() && !result.route.empty();
  write("gaps.kml", places.IsGeographic(), GapsKml);
  write("route.plan", has_route, RoutePlan);
  write("route.waypoints", has_route, RouteWaypoints);
  write("route.cmp", has_route, RouteCockpitMission);
}

// Of layers that an earlier run has found gaps in.
void RemoveFormerMaps(OutputFolder* folder) {
  for (const fs::path& file : FilesOfOurs(folder->Path())) {
    const std::string name = file.filename().string();
    if (name.rfind("map_", 0) == 0) folder->Remove(name);
  }
}

void WriteMaps(const CompletenessResult& result, const std::string& unit, OutputFolder* folder) {
  RemoveFormerMaps(folder);
  const ColorImage map = DrawGapMap(result, {Side::kTop, 0}, unit);
  if (!map.Empty()) WriteImage(folder->Path() / "map.png", map);
  for (const LayerKey& layer : LayersWithGaps(result)) {
    folder->Claim({MapName(layer)});
    WriteImage(folder->Path() / MapName(layer), DrawGapMap(result, layer, unit));
  }
}

}  // namespace

void WriteGapFiles(const GapFilesInput& input, OutputFolder* folder) {
  const fs::path& output = folder->Path();
  const auto& [model, result, places, changes] = input;
  WriteTextFile(output / "gaps.geojson", GapsGeoJson(result, model, places));
  WriteTextFile(output / "gaps.csv", GapsCsv(result, model, places));
  WriteGeographic(result, places, folder);
  WriteMaps(result, places.Unit(), folder);
  WriteTextFile(output / kCompletenessFile, CompletenessJson(result, model, places, changes));
}

}  // namespace colmap_seapoint
