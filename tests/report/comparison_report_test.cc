#include "colmap_seapoint/report/comparison_report.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace colmap_seapoint {
namespace {

// Every number another, so that none can stand in another's place.
ComparisonReport Report() {
  ComparisonReport report;
  report.input_path = "a.ply";
  report.reference_path = "b.ply";
  CloudComparison& c = report.comparison;
  c.distances = {0.25, 0.5};
  c.max_distance = 5;
  c.voxel_size = 0.125;
  c.cell_size = 0.0625;
  c.area_cell_size = 0.75;
  c.input = {1000, 0.03, 900, 10, 0.2, 0.3, 0.1, 40, 50, 60, 20.0, {}};
  c.input.at = {{600, 0.65, 200, 150, 4.0}, {800, 0.85, 100, 90, 1.0}};
  c.reference = {2000, 0.04, 1900, 20, 0.4, 0.6, 0.35, 80, 100, 120, 40.0, {}};
  c.reference.at = {{500, 0.35, 400, 100, 10.0}, {1000, 0.55, 300, 150, 8.0}};
  return report;
}

nlohmann::json Parsed(const ComparisonReport& report) {
  return nlohmann::json::parse(ComparisonJson(report));
}

TEST(ComparisonJsonTest, Clouds) {
  const nlohmann::json json = Parsed(Report());
  EXPECT_EQ(json["input"]["path"], "a.ply");
  EXPECT_EQ(json["input"]["points"], 1000);
  EXPECT_EQ(json["input"]["spacing"], 0.03);
  EXPECT_EQ(json["input"]["area"], 20.0);
  EXPECT_EQ(json["input"]["points_per_unit2"], 50.0);
  EXPECT_EQ(json["input"]["points_per_cell"], 20.0);
  EXPECT_EQ(json["reference"]["path"], "b.ply");
  EXPECT_EQ(json["reference"]["occupied_cells"], 100);
  EXPECT_EQ(json["max_distance"], 5.0);
  EXPECT_EQ(json["distances_are"], "as given");
}

TEST(ComparisonJsonTest, SquareCentimetresOnlyOfMetres) {
  ComparisonReport report = Report();
  EXPECT_TRUE(Parsed(report)["input"]["points_per_cm2"].is_null());
  EXPECT_EQ(Parsed(report)["unit"], "that of the clouds");
  report.unit_in_metres = true;
  EXPECT_NEAR(Parsed(report)["input"]["points_per_cm2"].get<double>(), 0.005, 1e-12);
  EXPECT_EQ(Parsed(report)["unit"], "metre");
}

TEST(ComparisonJsonTest, ScoresInThreeWays) {
  const nlohmann::json json = Parsed(Report());
  const auto& points = json["points"]["at"][0];
  EXPECT_EQ(points["accuracy"], 0.6);
  EXPECT_EQ(points["completeness"], 0.25);
  EXPECT_NEAR(points["f_score"].get<double>(), 2 * 0.6 * 0.25 / 0.85, 1e-12);
  const auto& eth3d = json["eth3d"]["at"][1];
  EXPECT_EQ(eth3d["accuracy"], 0.85);
  EXPECT_EQ(eth3d["completeness"], 0.55);
  const auto& tanks = json["tanks_and_temples"]["at"][0];
  EXPECT_EQ(tanks["precision"], 0.75);
  EXPECT_EQ(tanks["recall"], 0.25);
  EXPECT_EQ(tanks["voxel_size"], 0.125);
  EXPECT_EQ(tanks["reference_points"], 400);
  const auto& holes = json["holes"][1];
  EXPECT_EQ(holes["hole_area"], 8.0);
  EXPECT_EQ(holes["hole_share"], 0.2);
  EXPECT_EQ(holes["excess_share"], 0.05);
}

TEST(ComparisonJsonTest, FiguresThatDoNotExistAreNull) {
  ComparisonReport report = Report();
  report.comparison.input.mean = std::numeric_limits<double>::quiet_NaN();
  report.comparison.input.median = std::numeric_limits<double>::infinity();
  const auto distance = Parsed(report)["distance"]["input_to_reference"];
  EXPECT_TRUE(distance["mean"].is_null());
  EXPECT_TRUE(distance["median"].is_null());
  EXPECT_EQ(distance["rms"], 0.3);
  EXPECT_EQ(distance["points_beyond_max_distance"], 10);
}

TEST(ComparisonJsonTest, ANameThatIsNoUtf8DoesNotStopIt) {
  ComparisonReport report = Report();
  report.input_path = "a\xff.ply";
  EXPECT_EQ(Parsed(report)["input"]["path"], "a\xEF\xBF\xBD.ply");
}

TEST(ComparisonTableTest, OneLineACloudDistanceAndScore) {
  const std::string table = ComparisonTable(Report());
  for (const char* line :
       {"cloud            points      spacing         area   per unit^2     a cell\n",
        "input              1000         0.03           20           50     20.000\n",
        "input to reference            0.2          0.1          0.3           10\n",
        "points                     0.25     0.6000        0.2500    0.3529\n",
        "                            0.5     0.8000        0.5000    0.6154\n",
        "Tanks and Temples          0.25     0.7500        0.2500    0.3750\n",
        "                            0.5              8              1\n"}) {
    EXPECT_NE(table.find(line), std::string::npos) << line << "in\n" << table;
  }
}

}  // namespace
}  // namespace colmap_seapoint
