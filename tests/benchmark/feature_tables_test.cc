#include "examples/benchmarks/feature/feature_tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

FeatureRow MakeRow(const std::string& detector, int v1, int v2, double share, double seconds1,
                   double seconds2) {
  FeatureRow row;
  row.set = "reef";
  row.detector = detector;
  row.setting = "as it is";
  row.picture1 = "p" + std::to_string(v1);
  row.picture2 = "p" + std::to_string(v2);
  row.gap = v2 - v1;
  row.points1 = row.points2 = 3000;
  row.matched_share = share;
  row.verified_share = share / 2;
  row.reliable_area = share / 4;
  row.extract_cpu1 = seconds1;
  row.extract_cpu2 = seconds2;
  row.match_cpu = share;
  return row;
}

// Three pictures; SeaPoints takes 1, 2, 4 seconds and ORB 2, 8, 8: ratios 0.5, 0.25, 0.5.
std::vector<FeatureRow> Rows() {
  return {MakeRow("SeaPoints", 0, 1, 0.5, 1, 2),  MakeRow("SeaPoints", 1, 2, 0.75, 2, 4),
          MakeRow("SeaPoints", 0, 2, 0.25, 1, 4), MakeRow("ORB", 0, 1, 0.25, 2, 8),
          MakeRow("ORB", 1, 2, 0.25, 8, 8),       MakeRow("ORB", 0, 2, 0.125, 2, 8)};
}

TEST(FeatureTablesTest, MediansOfPairsAndRatiosOfPictures) {
  const std::string text = MarkdownTables(Rows());
  EXPECT_NE(
      text.find(
          "| reef | 3 | SeaPoints | as it is | 3000 | 25.0 | 62.5 | 12.5 | 31.2 | 6.2 | 15.6 |\n"),
      std::string::npos)
      << text;
  EXPECT_NE(text.find("| reef | ORB | 8.000 | 0.2500 | 8.250 | 0.50 | 2.00 |\n"), std::string::npos)
      << text;
  EXPECT_EQ(text.find("Against the truth"), std::string::npos);
}

TEST(FeatureTablesTest, TruthOnlyWhereItIsKnown) {
  std::vector<FeatureRow> rows = Rows();
  for (FeatureRow& row : rows) {
    if (row.detector == "ORB") continue;
    row.precision = 0.9;
    row.repeatability = 0.8;
    row.true_overlap = 0.5;
    row.overlap_error = row.picture1 == "p0" ? -0.125 : 0.25;
    row.textured = 0.5;
    row.recall = 0.75;
    row.area_precision = 1;
    row.texture_limit = 1.5;
  }
  const std::string text = MarkdownTables(rows);
  const std::string truth = text.substr(text.find("## Against the truth"));
  EXPECT_NE(
      truth.find("| reef | SeaPoints | 90.0 | 90.0 | 80.0 | 80.0 | 50.0 | -12.5 / 12.5 | 50.0 "
                 "| +6.2 / 18.8 | 75.0 | 75.0 | 100.0 | 100.0 | 50.0 | 1.5 |\n"),
      std::string::npos)
      << truth;
  EXPECT_EQ(truth.find("ORB"), std::string::npos);
}

TEST(FeatureTablesTest, PlotDataHasALineASet) {
  std::vector<FeatureRow> rows = Rows();
  rows.erase(rows.begin() + 5);  // no (V, V+2) for ORB
  EXPECT_EQ(PlotData(rows),
            "set\tmatched_2 SeaPoints\tmatched_1 SeaPoints\tarea_2 SeaPoints\tarea_1 SeaPoints"
            "\textract SeaPoints\tmatch SeaPoints\tmatched_2 ORB\tmatched_1 ORB\tarea_2 ORB"
            "\tarea_1 ORB\textract ORB\tmatch ORB\n"
            "reef\t25\t62.5\t6.25\t15.625\t2\t0.5\t?\t25\t?\t6.25\t8\t0.25\n");
}

TEST(FeatureRowsTest, RoundTripAndDamage) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "rows.csv";
  std::vector<FeatureRow> rows = Rows();
  rows[0].picture1 = "a,b|c.jpg";
  WriteFeatureRows(path, rows);
  const std::vector<FeatureRow> read = ReadFeatureRows(path);
  ASSERT_EQ(read.size(), rows.size());
  EXPECT_EQ(read[0].picture1, "a_b_c.jpg");
  for (size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(read[i].detector, rows[i].detector);
    EXPECT_EQ(read[i].setting, rows[i].setting);
    EXPECT_EQ(read[i].gap, rows[i].gap);
    EXPECT_EQ(read[i].matched_share, rows[i].matched_share);
    EXPECT_EQ(read[i].match_cpu, rows[i].match_cpu);
    EXPECT_TRUE(std::isnan(read[i].precision));
  }
  EXPECT_THROW(ReadFeatureRows(path.string() + ".missing"), Error);
  WriteTextFile(path, "set,detector\n");
  EXPECT_THROW(ReadFeatureRows(path), Error);
}

}  // namespace
}  // namespace colmap_seapoint
