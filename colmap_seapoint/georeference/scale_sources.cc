#include "colmap_seapoint/georeference/scale_sources.h"

#include <algorithm>

#include "colmap_seapoint/markers/marker_codes.h"
#include "colmap_seapoint/markers/marker_name.h"

namespace colmap_seapoint {

void ScaleSources::Bind(OptionTable* table) {
  table->Add(
      "scale_bars_path", &scale_bars_path,
      "table of known lengths, name1,name2,length_m[,sigma_m]: coded markers, which are found by "
      "themselves (tag36h11:12, DICT_4X4_50:3), names of targets, or point:ID for 3D points "
      "of the model",
      "ours");
  table->Add("targets_path", &targets_path,
             "table of the targets' marks, target,image,x,y (pixels; the first pixel's centre is "
             "0.5, 0.5), in 2 pictures each at least",
             "ours");
  table->Add("positions_path", &positions_path,
             "table of the cameras' positions, image,x,y,z (metres), image,lat,lon,alt or "
             "image,lat,lon,depth (degrees, metres), with [,sigma] or [,sigma_xy,sigma_z] if known",
             "ours");
  table->Add("crs", &crs,
             "projected reference system of the result, e.g. EPSG:32755: latitude and longitude "
             "are converted, x,y,z are taken as of it; empty = east, north, up of the place",
             "ours");
  table->Add("rig_spacing", &rig_spacing,
             "distance between the two cameras of the rig, metres; 0 = unknown", "ours", 0, 1000);
  table->Add("marker_size", &marker_size,
             "side of the black square of every coded marker in the scene, metres: each one found "
             "is a scale bar then; 0 = unknown",
             "ours", 0, 1000);
  table->Add(
      "marker_families", &marker_families,
      "which markers have marker_size: tag36h11, DICT_6X6, or both with a comma between them "
      "(smaller ones are found by chance too: name them as ends of bars)",
      "ours");
  table->Add("length_sigma", &length_sigma,
             "standard deviation of rig_spacing, marker_size, and of bars that do not give theirs, "
             "metres",
             "ours", 1e-9, 1000);
  table->Add("max_target_error", &max_target_error,
             "marks farther from their target's projection are not used, pixels", "ours", 0.01,
             1000);
}

bool ScaleSources::Any() const {
  return !scale_bars_path.empty() || !positions_path.empty() || rig_spacing > 0 || marker_size > 0;
}

std::string ScaleSources::Check() const {
  if (!targets_path.empty() && scale_bars_path.empty()) {
    return "targets_path is '" + targets_path +
           "', it needs scale_bars_path: the known lengths between the targets";
  }
  if (!crs.empty() && positions_path.empty()) {
    return "crs is '" + crs + "', it needs positions_path: the positions that it is for";
  }
  if (marker_size > 0) {
    const auto families = ParseMarkerFamilies(marker_families);
    const auto is_small = [](MarkerFamily family) { return NumMendedBits(family) == 0; };
    if (!families || std::any_of(families->begin(), families->end(), is_small)) {
      return "marker_families is '" + marker_families +
             "', must be tag36h11, DICT_6X6, or both with a comma between them";
    }
  }
  return "";
}

}  // namespace colmap_seapoint
