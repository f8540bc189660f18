#include "colmap_seapoint/pipeline/orthomosaic/map_settings.h"

#include <optional>
#include <sstream>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/csv_table.h"
#include "colmap_seapoint/orthomosaic/orthomosaic.h"

namespace colmap_seapoint {
namespace {

// Three numbers, separated by commas, that are not all 0.
std::optional<Eigen::Vector3d> ParseDirection(const std::string& text) {
  Eigen::Vector3d direction;
  std::istringstream fields(text);
  std::string field;
  int count = 0;
  for (; std::getline(fields, field, ','); ++count) {
    if (count == 3 || !ParseCsvNumber(field, &direction[count])) return std::nullopt;
  }
  if (count != 3 || !(direction.norm() > 0)) return std::nullopt;
  return direction;
}

bool IsNamedPlane(const std::string& plane) {
  return plane == "auto" || plane == "model" || plane == "fitted";
}

}  // namespace

void MapSettings::Bind(OptionTable* table, const std::string& prefix) {
  table->Add(prefix + "pixel_size", &pixel_size,
             "side of a pixel of the map, in the model's unit; 0 = the survey's ground sampling "
             "distance",
             "ours", 0, 1e6);
  table->Add(prefix + "fill", &fill,
             "also fill what lies between measured places up to 48 pixels apart; surface.tif marks "
             "it",
             "ours");
  table->Add(prefix + "plane", &plane,
             "what the map is seen across: auto = level where the model knows what is up (a wall "
             "across its own plane), else the best plane; model = x and y of the model; fitted = "
             "the best plane; or the direction that it is seen from, x,y,z in the model's frame",
             "ours");
  table->Add(prefix + "up", &up,
             "what points to the map's upper edge, x,y,z in the model's frame; empty = north, or "
             "the model's y, or what is up in the pictures",
             "ours");
  table->Add(prefix + "color", &color,
             "raw = as the pictures show it, one exposure for all; balanced = without what the "
             "water does, where the survey tells that, for the eye",
             "ours", {"raw", "balanced"});
}

std::string MapSettings::Check() const {
  if (!IsNamedPlane(plane) && !ParseDirection(plane)) {
    return "plane " + plane + ": must be auto, model, fitted, or a direction x,y,z";
  }
  if (!up.empty() && !ParseDirection(up)) {
    return "up " + up + ": must be a direction: three numbers x,y,z that are not all 0";
  }
  return "";
}

OrthomosaicOptions MapSettings::Options(int num_threads) const {
  SEAPOINT_CHECK(Check().empty());
  OrthomosaicOptions options;
  options.pixel_size = pixel_size;
  options.fill = fill;
  options.num_threads = num_threads;
  options.restore = color == "balanced";
  if (plane == "model") options.plane.plane = MapPlane::kModel;
  if (plane == "fitted") options.plane.plane = MapPlane::kFitted;
  if (!IsNamedPlane(plane)) options.plane.towards_eye = ParseDirection(plane);
  if (!up.empty()) options.plane.up = ParseDirection(up);
  return options;
}

}  // namespace colmap_seapoint
