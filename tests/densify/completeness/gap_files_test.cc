#include "colmap_seapoint/gaps/gap_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/gaps/completeness_json.h"
#include "colmap_seapoint/gaps/gap_kml.h"
#include "colmap_seapoint/gaps/gap_map.h"
#include "colmap_seapoint/io/files/atomic_file.h"
#include "colmap_seapoint/io/gis/area_geojson.h"
#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::json;

class GapFiles : public testing::Test {
 protected:
  static bool Keep(const Eigen::Vector2d& p) { return (p - Eigen::Vector2d(3.2, 4)).norm() > 0.8; }
  const SparseModel model_ = MakeFlatSurvey();
  const CompletenessResult result_ = AssessCompleteness(FlatInput(model_, Keep), {}, 2);
};

double AreaOfPolygon(const Json& rings) {
  double area = 0;
  for (const Json& ring : rings) {
    Ring corners;
    for (const Json& p : ring) corners.emplace_back(p[0].get<double>(), p[1].get<double>());
    area += SignedArea(corners);
  }
  return area;
}

TEST_F(GapFiles, GeoJsonInTheModelsFrame) {
  const GapPlaces places(ModelUnits(), result_.ground.frame);
  const Json json = Json::parse(GapsGeoJson(result_, model_, places));
  EXPECT_EQ(json.at("map_from_model"), Json::parse("[[1,0,0],[0,1,0],[0,0,1]]"));
  EXPECT_NE(json.at("frame").get<std::string>().find("not WGS84"), std::string::npos);
  size_t num_gaps = 0;
  for (const Json& feature : json.at("features")) {
    const Json& properties = feature.at("properties");
    if (properties.at("kind") != "gap") continue;
    ++num_gaps;
    const Json& rings = feature.at("geometry").at("coordinates");
    EXPECT_EQ(rings[0].front(), rings[0].back());
    EXPECT_NEAR(AreaOfPolygon(rings), properties.at("area").get<double>(), 1e-3);
  }
  EXPECT_EQ(num_gaps, result_.gaps.size());
}

TEST_F(GapFiles, Wgs84WhereGeoreferenced) {
  ModelUnits enu;
  enu.is_metric = true;
  enu.frame = "east-north-up";
  enu.origin = GeoPosition{43.1, 5.9, 0};
  ModelUnits utm;
  utm.is_metric = true;
  utm.frame = "projected";
  utm.crs = "EPSG:32631";
  utm.offset = {735966.0, 4776051.0, 0};  // near the same place
  for (const ModelUnits& units : {enu, utm}) {
    const GapPlaces places(units, result_.ground.frame);
    EXPECT_TRUE(places.IsGeographic());
    const Eigen::Vector3d a = places.Write({0, 0, -20}), b = places.Write({0, 100, -20});
    EXPECT_NEAR(a.x(), 5.9, 0.01);
    EXPECT_NEAR(a.y(), 43.1, 0.01);
    EXPECT_EQ(a.z(), -20);
    EXPECT_NEAR((b.y() - a.y()) * 111100, 100, 1);
    // There and back.
    const AskedArea area = AreaInPlan(units, {{a.head<2>(), b.head<2>()}});
    EXPECT_LT(area.rings[0][0].norm(), 1e-3);
    EXPECT_LT((area.rings[0][1] - Eigen::Vector2d(0, 100)).norm(), 1e-3);
  }
}

size_t CountOf(const std::string& text, const std::string& word) {
  size_t count = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST_F(GapFiles, Kml) {
  ModelUnits enu;
  enu.is_metric = true;
  enu.frame = "east-north-up";
  enu.origin = GeoPosition{43.1, 5.9, 0};
  const std::string kml = GapsKml(result_, GapPlaces(enu, result_.ground.frame));
  size_t num_rings = 0;
  for (const Gap& gap : result_.gaps) num_rings += gap.outline.size();
  EXPECT_EQ(CountOf(kml, "<Placemark>"), result_.gaps.size() + 1);
  EXPECT_EQ(CountOf(kml, "<LinearRing>"), num_rings);
  EXPECT_EQ(CountOf(kml, "<Polygon>"), CountOf(kml, "<outerBoundaryIs>"));
  EXPECT_EQ(CountOf(kml, "<Polygon>"), CountOf(kml, "</Polygon>"));
  // Longitude first; the survey begins at its origin.
  EXPECT_NE(kml.find("<coordinates>5.9"), std::string::npos);
}

TEST_F(GapFiles, ReportIsReadBack) {
  const GapPlaces places(ModelUnits(), result_.ground.frame);
  const auto path = std::filesystem::path(testing::TempDir()) / "completeness.json";
  WriteTextFile(path, CompletenessJson(result_, model_, places));
  const FormerReport former = ReadFormerReport(path);
  ASSERT_EQ(former.gaps.size(), result_.gaps.size());
  for (size_t i = 0; i < former.gaps.size(); ++i) {
    EXPECT_EQ(former.gaps[i].id, result_.gaps[i].id);
    EXPECT_EQ(former.gaps[i].rings, result_.gaps[i].outline);
  }
  EXPECT_EQ(former.last_id, result_.last_id);
  ASSERT_EQ(former.pictures.size(), model_.images.size());
  EXPECT_EQ(former.pictures[3].name, model_.images[3].name);
  EXPECT_EQ(former.pictures[3].cam_from_world.translation,
            model_.images[3].cam_from_world.translation);
  EXPECT_EQ(FormerReportText(ParseFormerReport(FormerReportText(former), "")),
            FormerReportText(former));
  WriteTextFile(path, "[]");
  EXPECT_THROW(ReadFormerReport(path), Error);
  std::filesystem::remove(path);
  EXPECT_TRUE(ReadFormerReport(path).gaps.empty());
}

TEST_F(GapFiles, TableAndMap) {
  const GapPlaces places(ModelUnits(), result_.ground.frame);
  const std::string csv = GapsCsv(result_, model_, places);
  EXPECT_EQ(static_cast<size_t>(std::count(csv.begin(), csv.end(), '\n')), result_.gaps.size() + 2);
  EXPECT_NE(csv.find("views_disagree,top,"), std::string::npos);
  EXPECT_FALSE(DrawGapMap(result_, {Side::kTop, 0}, "units").Empty());
  EXPECT_TRUE(DrawGapMap(result_, {Side::kLeft, 3}, "units").Empty());
}

TEST(LayerName, ThereAndBack) {
  for (const LayerKey& key : {LayerKey{Side::kTop, 0}, LayerKey{Side::kLeft, -12}}) {
    LayerKey read;
    ASSERT_TRUE(ParseLayerName(LayerName(key), &read));
    EXPECT_FALSE(read < key || key < read);
  }
  LayerKey read;
  EXPECT_FALSE(ParseLayerName("left:x", &read));
  EXPECT_FALSE(ParseLayerName("inside", &read));
}

TEST(ReadAreaGeoJson, PolygonsAndFaults) {
  const auto path = std::filesystem::path(testing::TempDir()) / "area.geojson";
  WriteTextFile(path,
                R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},
      "geometry":{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,0]]]}}]})");
  const auto rings = ReadAreaGeoJson(path, "--area");
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_EQ(rings[0].size(), 3u);
  for (const char* bad : {"", "{", "[]", R"({"type":"Point","coordinates":[1,2]})",
                          R"({"type":"Polygon","coordinates":[[[0,0],[4,0],[0,0]]]})",
                          R"({"type":"Polygon","coordinates":[[[0,0],[4],[0,1],[1,1]]]})",
                          R"({"type":"Polygon","coordinates":"x"})"}) {
    WriteTextFile(path, bad);
    EXPECT_THROW(ReadAreaGeoJson(path, "--area"), Error) << bad;
  }
}

}  // namespace
}  // namespace colmap_seapoint
