#include "colmap_seapoint/io/gis/area_geojson.h"

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/input_stream.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::json;
using Rings = std::vector<std::vector<Eigen::Vector2d>>;
constexpr char kRemedy[] = "give a GeoJSON file with a polygon";

void AddPolygon(const Json& polygon, Rings* rings) {
  for (const Json& ring : polygon) {
    auto& corners = rings->emplace_back();
    for (const Json& corner : ring) {
      corners.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
    }
    if (corners.size() > 1 && corners.front() == corners.back()) corners.pop_back();
  }
}

void AddGeometry(const Json& json, Rings* rings) {
  const auto type = json.at("type").get<std::string>();
  if (type == "Polygon") AddPolygon(json.at("coordinates"), rings);
  if (type == "MultiPolygon") {
    for (const Json& polygon : json.at("coordinates")) AddPolygon(polygon, rings);
  }
  if (type == "Feature") AddGeometry(json.at("geometry"), rings);
  if (type == "FeatureCollection") {
    for (const Json& feature : json.at("features")) AddGeometry(feature, rings);
  }
  if (type == "GeometryCollection") {
    for (const Json& part : json.at("geometries")) AddGeometry(part, rings);
  }
}

}  // namespace

Rings ReadAreaGeoJson(const std::filesystem::path& path, const std::string& option) {
  InputStream in(path);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string where = option + " " + path.string();
  Rings rings;
  try {
    AddGeometry(Json::parse(text), &rings);
  } catch (const Json::exception& e) {
    throw Error(where, "is no GeoJSON (" + std::string(e.what()) + ")", kRemedy);
  }
  if (rings.empty()) throw Error(where, "holds no polygon", kRemedy);
  for (const auto& ring : rings) {
    if (ring.size() < 3) throw Error(where, "has a ring of fewer than three corners", kRemedy);
    for (const Eigen::Vector2d& corner : ring) {
      if (!corner.allFinite()) throw Error(where, "has a corner that is no number", kRemedy);
    }
  }
  return rings;
}

}  // namespace colmap_seapoint
