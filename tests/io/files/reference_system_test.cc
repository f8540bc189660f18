// Where on the Earth coordinates lie, as text that files carry.
#include <gtest/gtest.h>
#include <proj.h>

#include <string>

#include "colmap_seapoint/base/geodesy.h"
#include "colmap_seapoint/io/files/map_projection.h"
#include "colmap_seapoint/io/files/model_units.h"
#include "tests/io/test_files.h"

namespace colmap_seapoint {
namespace {

TEST(WellKnownText, IsOfVersionOneWhereItCan) {
  const std::string text = WellKnownText("EPSG:32755", "map.tif");
  EXPECT_EQ(text.substr(0, 31), "PROJCS[\"WGS 84 / UTM zone 55S\",");
  EXPECT_EQ(text.find('\n'), std::string::npos);
  EXPECT_EQ(WellKnownText(text, "map.tif"), text);
}

TEST(WellKnownText, UnknownSystemsAreSaidWithTheFile) {
  for (const char* crs : {"EPSG:99999999", "", "utm 55", "/etc/passwd", "EPSG:7030"}) {
    EXPECT_ERROR(WellKnownText(crs, "map.tif"), "map.tif: its reference system");
  }
}

TEST(ReferenceSystem, IsTheCrsOrThePlaneOfTheOriginOrNone) {
  ModelUnits units;
  EXPECT_EQ(ReferenceSystem(units), "");
  units.is_metric = true;
  EXPECT_EQ(ReferenceSystem(units), "");
  units.frame = "projected";
  units.crs = "EPSG:32755";
  EXPECT_EQ(ReferenceSystem(units), "EPSG:32755");
  units.is_metric = false;
  EXPECT_EQ(ReferenceSystem(units), "");
}

// East and north of a place near the origin: by us, and by PROJ from the text that we write.
TEST(ReferenceSystem, EastNorthUpIsWhatProjMakesOfIt) {
  ModelUnits units;
  units.is_metric = true;
  units.frame = "east-north-up";
  units.origin = GeoPosition{-33.9, 151.2, 0};
  const std::string wkt = WellKnownText(ReferenceSystem(units), "map.tif");
  PJ_CONTEXT* context = proj_context_create();
  PJ* raw = proj_create_crs_to_crs(context, "EPSG:4326", wkt.c_str(), nullptr);
  ASSERT_NE(raw, nullptr);
  PJ* transformation = proj_normalize_for_visualization(context, raw);
  for (const auto& [d_lat, d_lon] : {std::pair(0.0, 0.0), {0.004, 0.003}, {-0.002, 0.006}}) {
    const GeoPosition place{-33.9 + d_lat, 151.2 + d_lon, 0};
    const Eigen::Vector3d expected = LocalEastNorthUp(place, *units.origin);
    const PJ_COORD is = proj_trans(transformation, PJ_FWD,
                                   proj_coord(place.longitude_deg, place.latitude_deg, 0, 0));
    // Ours takes a degree to be as long everywhere as at the origin.
    const double tolerance = 1e-9 + 5e-5 * expected.norm();
    EXPECT_NEAR(is.xy.x, expected.x(), tolerance);
    EXPECT_NEAR(is.xy.y, expected.y(), tolerance);
  }
  proj_destroy(transformation);
  proj_destroy(raw);
  proj_context_destroy(context);
}

TEST(ModelUnits, AreReadFromAFileOfAnyName) {
  const TempDir dir;
  ModelUnits units;
  units.is_metric = true;
  units.offset = {1, 2, 3};
  WriteModelUnits(dir.Path(), units);
  std::filesystem::rename(dir / kUnitsFile, dir / "of_the_dive.json");
  EXPECT_EQ(ReadModelUnitsFile(dir / "of_the_dive.json").offset, units.offset);
  EXPECT_ERROR(ReadModelUnitsFile(dir / "none.json"), "none.json");
  WriteBytes(dir / "bad.json", "{}");
  EXPECT_ERROR(ReadModelUnitsFile(dir / "bad.json"), "is no description of units");
}

}  // namespace
}  // namespace colmap_seapoint
