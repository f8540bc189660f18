#include "colmap_seapoint/gaps/gap_files.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/io/files/csv_table.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::ordered_json;

// Degrees to a millimetre, units to 6 digits behind the point.
double Rounded(double value, double digits) {
  const double scale = std::pow(10, digits);
  return std::round(value * scale) / scale;
}

Json Coordinates(const GapPlaces& places, const Eigen::Vector3d& world) {
  const Eigen::Vector3d p = places.Write(world);
  const double digits = places.IsGeographic() ? 8 : 6;
  return {Rounded(p.x(), digits), Rounded(p.y(), digits), Rounded(p.z(), 6)};
}

Json Line(const GapPlaces& places, const std::vector<Eigen::Vector3d>& corners) {
  Json line = Json::array();
  for (const Eigen::Vector3d& corner : corners) line.push_back(Coordinates(places, corner));
  return line;
}

// A Polygon where the gap is in one piece, else a MultiPolygon.
Json Polygons(const GapPlaces& places, const Gap& gap) {
  Json polygons = Json::array();
  for (size_t i = 0; i < gap.outline.size(); ++i) {
    Json ring = Line(places, gap.outline[i]);
    ring.push_back(ring.front());
    const bool is_outer = SignedArea(gap.region.rings[i]) > 0;
    if (is_outer || polygons.empty()) polygons.push_back(Json::array());
    polygons.back().push_back(std::move(ring));
  }
  if (polygons.size() == 1) return {{"type", "Polygon"}, {"coordinates", polygons[0]}};
  return {{"type", "MultiPolygon"}, {"coordinates", std::move(polygons)}};
}

Json PassProperties(const ClosingPass& pass) {
  return {{"heading_deg", Rounded(pass.heading_deg, 1)}, {"altitude", Rounded(pass.altitude, 4)},
          {"tilt_deg", Rounded(pass.tilt_deg, 1)},       {"num_lines", pass.num_lines},
          {"num_pictures", pass.num_pictures},           {"length", Rounded(pass.length, 4)}};
}

Json Feature(Json geometry, Json properties) {
  return {{"type", "Feature"},
          {"geometry", std::move(geometry)},
          {"properties", std::move(properties)}};
}

Json GapProperties(const Gap& gap, const SparseModel& model, const GapPlaces& places, int rank) {
  Json pictures = Json::array();
  for (const int i : gap.pictures) pictures.push_back(model.images[static_cast<size_t>(i)].name);
  return {{"kind", "gap"},
          {"id", gap.id},
          {"rank", rank},
          {"cause", GapCauseName(gap.region.cause)},
          {"layer", LayerName(gap.region.layer)},
          {"area", gap.region.area},
          {"unit", places.Unit()},
          {"height", Rounded(places.Write(gap.centroid).z(), 4)},
          {"surface", "predicted"},
          {"pictures", std::move(pictures)}};
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.9g", value);
  return text;
}

// 1-based place of each gap on the route.
std::vector<int> PlacesOnRoute(const CompletenessResult& result) {
  std::vector<int> at(result.gaps.size(), 0);
  for (size_t k = 0; k < result.route.size(); ++k) {
    at[static_cast<size_t>(result.route[k].pass)] = static_cast<int>(k) + 1;
  }
  return at;
}

std::string PlaceText(const GapPlaces& places, const Eigen::Vector3d& world) {
  const Eigen::Vector3d p = places.Write(world);
  char text[96];
  std::snprintf(text, sizeof(text), places.IsGeographic() ? "%.8f,%.8f,%.4f" : "%.6f,%.6f,%.6f",
                p.x(), p.y(), p.z());
  return text;
}

}  // namespace

std::string LayerName(const LayerKey& layer) {
  if (layer.side == Side::kTop) return SideName(layer.side);
  return std::string(SideName(layer.side)) + ":" + std::to_string(layer.slab);
}

bool ParseLayerName(const std::string& name, LayerKey* layer) {
  const size_t colon = name.find(':');
  for (int i = 0; i < kNumSides; ++i) {
    const auto side = static_cast<Side>(i);
    if (name.substr(0, colon) != SideName(side)) continue;
    int slab = 0, num_read = 0;
    if (colon != std::string::npos) {
      const char* text = name.c_str() + colon + 1;
      if (std::sscanf(text, "%d%n", &slab, &num_read) != 1 || text[num_read] != '\0') return false;
    }
    *layer = {side, slab};
    return true;
  }
  return false;
}

std::vector<Eigen::Vector3d> RouteCorners(const CompletenessResult& result) {
  std::vector<Eigen::Vector3d> corners;
  for (const RouteStop& stop : result.route) {
    const std::vector<Eigen::Vector3d>& pass =
        result.gaps[static_cast<size_t>(stop.pass)].pass.corners;
    if (stop.is_reversed) {
      corners.insert(corners.end(), pass.rbegin(), pass.rend());
    } else {
      corners.insert(corners.end(), pass.begin(), pass.end());
    }
  }
  return corners;
}

std::string GapsGeoJson(const CompletenessResult& result, const SparseModel& model,
                        const GapPlaces& places) {
  Json json = {{"type", "FeatureCollection"}, {"frame", places.Description()}};
  if (!places.IsGeographic()) {
    Json rows = Json::array();
    for (int i = 0; i < 3; ++i) {
      const Eigen::RowVector3d row = result.ground.frame.map_from_world.row(i);
      rows.push_back({row.x(), row.y(), row.z()});
    }
    json["map_from_model"] = std::move(rows);
  }
  Json features = Json::array();
  for (size_t i = 0; i < result.gaps.size(); ++i) {
    const Gap& gap = result.gaps[i];
    features.push_back(
        Feature(Polygons(places, gap), GapProperties(gap, model, places, static_cast<int>(i) + 1)));
  }
  for (const Gap& gap : result.gaps) {
    Json properties = {{"kind", "pass"}, {"gap", gap.id}};
    properties.update(PassProperties(gap.pass));
    features.push_back(Feature(
        {{"type", "LineString"}, {"coordinates", Line(places, gap.pass.corners)}}, properties));
  }
  if (!result.route.empty()) {
    features.push_back(
        Feature({{"type", "LineString"}, {"coordinates", Line(places, RouteCorners(result))}},
                {{"kind", "route"}, {"length", result.route_length}, {"unit", places.Unit()}}));
  }
  json["features"] = std::move(features);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string GapsCsv(const CompletenessResult& result, const SparseModel& model,
                    const GapPlaces& places) {
  const std::string place = places.IsGeographic() ? "longitude,latitude,altitude" : "x,y,z";
  const auto end = [&](const char* name) {
    std::string text;
    for (const char* axis : {"x", "y", "z"}) {
      const char* geographic = *axis == 'x' ? "longitude" : *axis == 'y' ? "latitude" : "altitude";
      text += std::string(",") + name + "_" + (places.IsGeographic() ? geographic : axis);
    }
    return text;
  };
  std::string csv = "# " + places.Description() + "; areas and lengths in " + places.Unit() + "\n";
  csv += "rank,id,cause,layer,area," + place +
         ",area_per_length,route_order,heading_deg,camera_height,tilt_deg,lines,pictures,length" +
         end("begin") + end("end") + ",nearest_pictures\n";
  const std::vector<int> on_route = PlacesOnRoute(result);
  for (size_t i = 0; i < result.gaps.size(); ++i) {
    const Gap& gap = result.gaps[i];
    const ClosingPass& pass = gap.pass;
    std::string names;
    for (const int k : gap.pictures) {
      names += (names.empty() ? "" : " ") + model.images[static_cast<size_t>(k)].name;
    }
    csv += std::to_string(i + 1) + "," + std::to_string(gap.id) + "," +
           GapCauseName(gap.region.cause) + "," + LayerName(gap.region.layer) + "," +
           Number(gap.region.area) + "," + PlaceText(places, gap.centroid) + "," +
           Number(gap.AreaPerLength()) + "," + std::to_string(on_route[i]) + "," +
           Number(Rounded(pass.heading_deg, 1)) + "," + Number(pass.altitude) + "," +
           Number(Rounded(pass.tilt_deg, 1)) + "," + std::to_string(pass.num_lines) + "," +
           std::to_string(pass.num_pictures) + "," + Number(pass.length) + "," +
           PlaceText(places, pass.Begin()) + "," + PlaceText(places, pass.End()) + "," +
           CsvField(names) + "\n";
  }
  return csv;
}

}  // namespace colmap_seapoint
