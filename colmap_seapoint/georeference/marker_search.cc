#include "colmap_seapoint/georeference/marker_search.h"

#include <algorithm>
#include <set>
#include <utility>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/scale_csv.h"

namespace colmap_seapoint {
namespace {

constexpr size_t kMostNames = 5;

// Real ones, not mirror images.
MarkerCounts CountMarkers(const std::vector<MarkerSighting>& sightings) {
  MarkerCounts counts;
  for (const MarkerSighting& sighting : sightings) {
    const auto name = ParseMarkerName(sighting.marker).name;
    if (name && !sighting.is_mirrored) ++counts[*name];
  }
  return counts;
}

}  // namespace

std::vector<MarkerName> MarkersOfBars(const ScaleSources& sources) {
  if (sources.scale_bars_path.empty()) return {};
  std::set<std::string> marked;
  if (!sources.targets_path.empty()) {
    for (const TargetMark& mark : ReadTargetsCsv(sources.targets_path)) marked.insert(mark.target);
  }
  std::set<MarkerName> names;
  for (const ScaleBar& bar : ReadScaleBarsCsv(sources.scale_bars_path)) {
    for (const ScaleBarEnd& end : bar.ends) {
      if (marked.count(end.name) > 0) continue;
      const ParsedMarker parsed = ParseMarkerName(end.name);
      if (!parsed.problem.empty()) {
        throw Error(bar.where, "there is no marker " + end.name,
                    "write its number: " + parsed.problem);
      }
      if (parsed.name) names.insert(*parsed.name);
    }
  }
  return {names.begin(), names.end()};
}

std::vector<MarkerFamily> FamiliesToFind(const ScaleSources& sources) {
  std::set<MarkerFamily> families;
  for (const MarkerName& name : MarkersOfBars(sources)) families.insert(name.family);
  if (sources.marker_size > 0) {
    const auto sized = ParseMarkerFamilies(sources.marker_families);
    if (sized) families.insert(sized->begin(), sized->end());
  }
  return {families.begin(), families.end()};
}

std::vector<std::string> MissingMarkers(const ScaleSources& sources,
                                        const std::vector<MarkerSighting>& sightings) {
  const MarkerCounts counts = CountMarkers(sightings);
  std::vector<std::string> lines;
  for (const MarkerName& name : MarkersOfBars(sources)) {
    const auto found = counts.find(name);
    if (found != counts.end() && found->second >= 2) continue;
    lines.push_back(sources.scale_bars_path + ": " + MarkerText(name) + " is found in " +
                    (found == counts.end() ? "no picture" : "one picture only") +
                    "; found: " + MostFound(counts));
  }
  return lines;
}

std::string MostFound(const MarkerCounts& counts) {
  std::vector<std::pair<size_t, MarkerName>> order;
  for (const auto& [name, count] : counts) order.emplace_back(count, name);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string text;
  for (size_t i = 0; i < std::min(order.size(), kMostNames); ++i) {
    text += (text.empty() ? "" : ", ") + MarkerText(order[i].second);
  }
  if (order.size() > kMostNames) text += ", ...";
  return text.empty() ? "none" : text;
}

}  // namespace colmap_seapoint
