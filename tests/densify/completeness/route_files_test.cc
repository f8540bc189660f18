#include "colmap_seapoint/gaps/route_files.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "colmap_seapoint/gaps/gap_files.h"
#include "tests/densify/completeness/flat_survey.h"

namespace colmap_seapoint {
namespace {

using Json = nlohmann::json;

// A survey at sea, its seabed 20 m down, its pictures from 15 m down; or on land, 100 m up.
class RouteFiles : public testing::Test {
 protected:
  static bool Keep(const Eigen::Vector2d& p) {
    return (p - Eigen::Vector2d(1.6, 2.4)).norm() > 0.8;
  }
  static ModelUnits Units(double up) {
    ModelUnits units;
    units.is_metric = true;
    units.frame = "east-north-up";
    units.origin = GeoPosition{43.1, 5.9, 0};
    units.offset = {0, 0, up};
    return units;
  }
  GapPlaces PlacesAt(double up) const { return GapPlaces(Units(up), result_.ground.frame); }

  const SparseModel model_ = MakeFlatSurvey({2, 4, 1.6, 3.2});
  const CompletenessResult result_ = AssessCompleteness(FlatInput(model_, Keep), {}, 2);
  const std::vector<Eigen::Vector3d> corners_ = RouteCorners(result_);
};

TEST_F(RouteFiles, PlanHoldsEveryCornerInWgs84) {
  const GapPlaces places = PlacesAt(-20);
  const Json plan = Json::parse(RoutePlan(result_, places));
  EXPECT_EQ(plan.at("fileType"), "Plan");
  EXPECT_EQ(plan.at("version"), 1);
  const Json& mission = plan.at("mission");
  EXPECT_EQ(mission.at("version"), 2);
  EXPECT_EQ(mission.at("plannedHomePosition").size(), 3u);
  EXPECT_EQ(mission.at("plannedHomePosition")[2], 0);
  ASSERT_EQ(mission.at("items").size(), corners_.size());
  for (size_t k = 0; k < corners_.size(); ++k) {
    const Json& item = mission.at("items")[k];
    const Eigen::Vector3d place = places.Write(corners_[k]);
    EXPECT_EQ(item.at("type"), "SimpleItem");
    EXPECT_EQ(item.at("command"), 16);
    EXPECT_EQ(item.at("doJumpId"), k + 1);
    EXPECT_EQ(item.at("frame"), 3);  // relative to the start, at the surface
    EXPECT_EQ(item.at("AltitudeMode"), 1);
    ASSERT_EQ(item.at("params").size(), 7u);
    EXPECT_NEAR(item.at("params")[4].get<double>(), place.y(), 1e-8);
    EXPECT_NEAR(item.at("params")[5].get<double>(), place.x(), 1e-8);
    EXPECT_NEAR(item.at("params")[6].get<double>(), -20 + kFlatAltitude, 0.1);
    EXPECT_EQ(item.at("params")[6], item.at("Altitude"));
  }
}

TEST_F(RouteFiles, WaypointsHaveTwelveFieldsAndHomeFirst) {
  std::istringstream text(RouteWaypoints(result_, PlacesAt(100)));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "QGC WPL 110");
  size_t number = 0;
  while (std::getline(text, line)) {
    std::istringstream fields(line);
    std::vector<double> values;
    for (double value = 0; fields >> value;) values.push_back(value);
    ASSERT_EQ(values.size(), 12u) << line;
    EXPECT_EQ(values[0], static_cast<double>(number));
    EXPECT_EQ(values[1], number == 0 ? 1 : 0);
    EXPECT_EQ(values[2], 0);  // above the sea
    EXPECT_EQ(values[3], 16);
    const Eigen::Vector3d place = PlacesAt(100).Write(corners_[number == 0 ? 0 : number - 1]);
    EXPECT_NEAR(values[8], place.y(), 1e-8);
    EXPECT_NEAR(values[9], place.x(), 1e-8);
    EXPECT_NEAR(values[10], place.z(), 0.005);
    ++number;
  }
  EXPECT_EQ(number, corners_.size() + 1);
}

// What Cockpit asks of a file before it takes it.
TEST_F(RouteFiles, CockpitsMissionHasItsKeys) {
  const Json mission = Json::parse(RouteCockpitMission(result_, PlacesAt(-20)));
  EXPECT_EQ(mission.at("version"), 0);
  for (const char* key : {"mapCenter", "zoom", "currentWaypointAltitude",
                          "currentWaypointAltitudeRefType", "defaultCruiseSpeed"}) {
    EXPECT_TRUE(mission.at("settings").contains(key)) << key;
  }
  EXPECT_TRUE(mission.at("settings").at("mapCenter").is_array());
  ASSERT_EQ(mission.at("waypoints").size(), corners_.size());
  std::set<std::string> ids;
  for (const Json& waypoint : mission.at("waypoints")) {
    ids.insert(waypoint.at("id").get<std::string>());
    ASSERT_EQ(waypoint.at("coordinates").size(), 2u);
    EXPECT_NEAR(waypoint.at("coordinates")[0].get<double>(), 43.1, 0.01);  // latitude first
    EXPECT_EQ(waypoint.at("altitudeReferenceType"), "Relative to home");
    ASSERT_TRUE(waypoint.at("commands").is_array());
    ASSERT_EQ(waypoint.at("commands").size(), 1u);
    EXPECT_EQ(waypoint.at("commands")[0].at("command"), "MAV_CMD_NAV_WAYPOINT");
  }
  EXPECT_EQ(ids.size(), corners_.size());
}

}  // namespace
}  // namespace colmap_seapoint
