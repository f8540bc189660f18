#include "colmap_seapoint/pipeline/orthomosaic/map_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/io/files/csv_table.h"
#include "colmap_seapoint/report/format_text.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

double Area(uint64_t num_pixels, const MapGrid& grid) {
  return static_cast<double>(num_pixels) * grid.pixel_size * grid.pixel_size;
}

// Rows of the 3 x 4 matrix.
Json MatrixOf(const Rigid3d& b_from_a) {
  const Eigen::Matrix3d rotation = b_from_a.rotation.matrix();
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) {
    rows.push_back({rotation(i, 0), rotation(i, 1), rotation(i, 2), b_from_a.translation[i]});
  }
  return rows;
}

Json NamesOf(const std::vector<size_t>& pictures, const SparseModel& model) {
  Json names = Json::array();
  for (const size_t i : pictures) names.push_back(model.images[i].name);
  return names;
}

Json Channels(const Eigen::Array3d& values) { return {values[0], values[1], values[2]}; }

// Red, green, blue; rates are by the map's unit.
Json WaterJson(const WaterModel& water) {
  Json json = {{"determined", water.IsDetermined()}, {"what", WaterText(water)}};
  if (!water.IsDetermined()) return json;
  json["attenuation"] = Channels(water.attenuation);
  json["veil"] = Channels(water.veil);
  json["veil_rate"] = Channels(water.veil_rate);
  json["falloff"] = water.falloff;
  json["white"] = Channels(water.white);
  return json;
}

std::string Length(double length, bool is_metric) {
  if (!is_metric) return Format("%.4g", length);
  return length < 0.1 ? Format("%.3g mm", 1000 * length) : Format("%.3g m", length);
}

}  // namespace

std::string MapJson(const OrthomosaicSummary& map, const MapPlacement& placement,
                    const SparseModel& model) {
  const MapGrid& grid = map.grid;
  Json json;
  json["version"] = Version();
  json["width"] = grid.width;
  json["height"] = grid.height;
  json["pixel_size"] = grid.pixel_size;
  json["gsd"] = map.gsd;
  json["cell_size_pixels"] = map.cell_size;
  json["unit"] = placement.unit.empty() ? "arbitrary" : placement.unit;
  json["min_x"] = grid.left + placement.offset.x();
  json["max_y"] = grid.top + placement.offset.y();
  json["crs"] = placement.crs.empty() ? Json() : Json(placement.crs);
  json["frame"] = map.frame.text;
  json["is_north_up"] = map.frame.is_north_up;
  json["map_from_model"] = MatrixOf(map.frame.map_from_cloud);
  json["offset"] = {placement.offset.x(), placement.offset.y(), placement.offset.z()};
  json["what"] = "map_from_model x (a place of the model) + offset = coordinates of the files";
  json["pixels"] = {
      {"surface", map.num_surface_pixels},   {"colored", map.num_colored_pixels},
      {"bridged", map.num_bridged_pixels},   {"filled", map.num_filled_pixels},
      {"overhang", map.num_overhang_pixels}, {"points_outside", map.num_points_outside}};
  json["surface_area"] = Area(map.num_surface_pixels, grid);
  json["colored_area"] = Area(map.num_colored_pixels, grid);
  json["pictures"] = {{"in_model", model.images.size()},
                      {"used", map.pictures_used.size()},
                      {"placed_and_balanced_by", map.memory.first_pictures},
                      {"unread", NamesOf(map.pictures_unread, model)}};
  json["color"] = map.water && map.water->IsDetermined() ? "balanced" : "raw";
  if (map.water) json["water"] = WaterJson(*map.water);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string SourceTable(const OrthomosaicSummary& map, const SparseModel& model) {
  std::string table = "label,name,used\n";
  for (size_t i = 0; i < model.images.size(); ++i) {
    const bool is_used = std::binary_search(map.pictures_used.begin(), map.pictures_used.end(), i);
    table += std::to_string(i + 1) + "," + CsvField(model.images[i].name) + "," +
             (is_used ? "1" : "0") + "\n";
  }
  return table;
}

std::string MapLine(const OrthomosaicSummary& map, const MapPlacement& placement) {
  const MapGrid& grid = map.grid;
  const bool is_metric = !placement.unit.empty();
  const double surface = static_cast<double>(std::max<uint64_t>(map.num_surface_pixels, 1));
  std::string line = Format("%d x %d pixels of %s", grid.width, grid.height,
                            Length(grid.pixel_size, is_metric).c_str());
  if (is_metric) line += Format(", %.4g m2 of surface", Area(map.num_surface_pixels, grid));
  line +=
      Format(", %.1f %% of it coloured, from %zu pictures",
             100 * static_cast<double>(map.num_colored_pixels) / surface, map.pictures_used.size());
  if (map.num_filled_pixels > 0) {
    line += Format(", %.1f %% filled", 100 * static_cast<double>(map.num_filled_pixels) / surface);
  }
  line += "; " + map.frame.text;
  if (!map.water) return line;
  return line + "; " + WaterText(*map.water) +
         (map.water->IsDetermined() ? "" : ", so that colours stay raw");
}

}  // namespace colmap_seapoint
