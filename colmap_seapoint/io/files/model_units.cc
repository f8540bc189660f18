#include "colmap_seapoint/io/files/model_units.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

std::string Fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", digits, value);
  return text;
}

ModelUnits FromJson(const Json& json) {
  ModelUnits units;
  units.is_metric = json.at("units").get<std::string>() == "metres";
  units.frame = json.at("frame").get<std::string>();
  units.crs = json.value("crs", "");
  if (json.contains("origin")) {
    const Json& origin = json["origin"];
    units.origin =
        GeoPosition{origin.at("latitude_deg"), origin.at("longitude_deg"), origin.at("altitude_m")};
  }
  for (int i = 0; i < 3; ++i) units.offset[i] = json.at("offset").at(static_cast<size_t>(i));
  const auto sigma = json.find("scale_sigma_relative");
  if (sigma != json.end() && sigma->is_number()) units.scale_sigma_relative = *sigma;
  return units;
}

ModelUnits Parse(const std::filesystem::path& path, std::istream* stream) {
  try {
    return FromJson(Json::parse(*stream));
  } catch (const Json::exception& error) {
    throw Error(path.string(), std::string("is no description of units (") + error.what() + ")",
                "write it again with model_scaler, or remove it: units are arbitrary then");
  }
}

}  // namespace

std::optional<ModelUnits> ReadModelUnits(const std::filesystem::path& dir) {
  const std::filesystem::path path = dir / kUnitsFile;
  const std::unique_ptr<InputStream> file = OpenIfThere(path);
  if (file == nullptr) return std::nullopt;
  return Parse(path, file.get());
}

ModelUnits ReadModelUnitsFile(const std::filesystem::path& path) {
  InputStream file(path);
  return Parse(path, &file);
}

void WriteModelUnits(const std::filesystem::path& dir, const ModelUnits& units) {
  Json json;
  json["units"] = units.is_metric ? "metres" : "arbitrary";
  json["frame"] = units.frame;
  if (!units.crs.empty()) json["crs"] = units.crs;
  if (units.origin) {
    json["origin"] = {{"latitude_deg", units.origin->latitude_deg},
                      {"longitude_deg", units.origin->longitude_deg},
                      {"altitude_m", units.origin->altitude_m}};
  }
  json["offset"] = {units.offset.x(), units.offset.y(), units.offset.z()};
  json["what"] = "coordinates of the files here + offset = coordinates of the frame";
  json["scale_sigma_relative"] = units.is_metric ? Json(units.scale_sigma_relative) : Json();
  WriteTextFile(dir / kUnitsFile, json.dump(2) + "\n");
}

std::string ReferenceSystem(const ModelUnits& units) {
  if (!units.is_metric) return "";
  if (units.frame == "projected") return units.crs;
  if (units.frame != "east-north-up" || !units.origin) return "";
  return "+proj=ortho +lat_0=" + Fixed(units.origin->latitude_deg, 12) +
         " +lon_0=" + Fixed(units.origin->longitude_deg, 12) +
         " +datum=WGS84 +units=m +no_defs +type=crs";
}

std::string UnitsWord(const std::optional<ModelUnits>& units) {
  return units && units->is_metric ? "metres" : "arbitrary";
}

std::string UnitsText(const std::optional<ModelUnits>& units) {
  if (!units || !units->is_metric) return "units arbitrary";
  std::string text = "metres, ";
  if (units->frame == "model") return text + "frame of the mapper (not levelled)";
  text += units->frame == "projected" ? units->crs : units->frame;
  if (units->origin) {
    text += " of latitude " + Fixed(units->origin->latitude_deg, 7) + ", longitude " +
            Fixed(units->origin->longitude_deg, 7);
  }
  if (!units->offset.isZero()) {
    text += "; add " + Fixed(units->offset.x(), 0) + " " + Fixed(units->offset.y(), 0) + " " +
            Fixed(units->offset.z(), 0);
  }
  return text;
}

}  // namespace colmap_seapoint
