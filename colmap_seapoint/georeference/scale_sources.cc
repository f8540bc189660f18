#include "colmap_seapoint/georeference/scale_sources.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <sstream>

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
  table->Add(
      "positions_path", &positions_path,
      "table of the cameras' positions, image,x,y,z (metres), image,lat,lon,alt or "
      "image,lat,lon,depth (degrees, metres), with [,sigma] or [,sigma_xy,sigma_z] if known; "
      "empty = GPS and depth of the pictures' EXIF, where nothing else says how large the "
      "model is; none = not even those",
      "ours");
  table->Add("nav", &nav,
             "log of the vehicle: a table with a header that names time (ISO 8601 or seconds), lat "
             "and lon or x and y, and depth or altitude, among others; several logs of one dive "
             "separated by commas. How far its clock is from the camera's is found from the track",
             "ours");
  table->Add("nav_times", &nav_times,
             "table of the pictures' times, image,time, for nav; empty = from their EXIF", "ours");
  table->Add("nav_offset", &nav_offset,
             "seconds that the log's clock is ahead of the camera's; auto = found from the track",
             "ours");
  table->Add("max_nav_offset", &max_nav_offset,
             "seconds that the two clocks may differ, time zones apart", "ours", 0, 86400);
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
  return !scale_bars_path.empty() || HasPositionTable() || !nav.empty() || rig_spacing > 0 ||
         marker_size > 0;
}

std::optional<double> ScaleSources::NavOffset() const {
  if (nav_offset == kAutoOffset) return std::nullopt;
  std::istringstream text(nav_offset);
  text.imbue(std::locale::classic());
  double seconds = std::numeric_limits<double>::quiet_NaN();
  if (!(text >> seconds) || !(text >> std::ws).eof()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return seconds;
}

std::string ScaleSources::Check() const {
  if (!targets_path.empty() && scale_bars_path.empty()) {
    return "targets_path is '" + targets_path +
           "', it needs scale_bars_path: the known lengths between the targets";
  }
  if (!nav.empty() && HasPositionTable()) {
    return "nav is '" + nav + "' and positions_path is '" + positions_path +
           "': give one of them, both say where the cameras were";
  }
  if (nav.empty() && (!nav_times.empty() || nav_offset != kAutoOffset)) {
    return "nav_times and nav_offset need nav: the log that they are for";
  }
  if (!std::isfinite(NavOffset().value_or(0))) {
    return "nav_offset is '" + nav_offset + "', it must be auto or a number of seconds";
  }
  if (!crs.empty() && ((Any() && !HasPositionTable() && nav.empty()) || DeclinesPositions())) {
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
