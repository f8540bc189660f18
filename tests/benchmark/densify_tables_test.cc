#include "examples/benchmarks/densify/densify_tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/atomic_file.h"

namespace colmap_seapoint {
namespace {

DensifyRow MakeRow(const std::string& variant, double cpu, double points) {
  DensifyRow row;
  row.set = "reef";
  row.variant = variant;
  row.pictures = 8;
  row.megapixels = 16;
  row.cpu = cpu;
  row.wall = cpu / 2;
  row.pairs = 4;
  row.pair_seconds = cpu / 4;
  row.points = points;
  row.layers = 1.5;
  return row;
}

std::vector<DensifyRow> Rows() {
  std::vector<DensifyRow> rows = {MakeRow("complete", 8, 1000), MakeRow("sequential", 3, 500)};
  rows[1].true_new_share = 0.5;
  rows[1].true_new_later = 0.4;
  rows[1].seeds_kept = 0.25;
  return rows;
}

TEST(DensifyTablesTest, RatiosArePartialOverComplete) {
  const std::string text = DensifyTables({Rows(), {}, {}});
  EXPECT_NE(text.find("| reef | sequential | 8 | 16.0 | 4 | 3.00 | 0.375 | 1.50 | 0.375 | 0.1875 "
                      "| 500 | 0.500 | 1.50 | – | – |\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("| reef | complete | 8 | 16.0 | 4 | 8.00 | – |"), std::string::npos) << text;
  EXPECT_NE(text.find("| reef | sequential | 2.000 | 0.750 | 0.38 |"), std::string::npos) << text;
  EXPECT_NE(text.find("| reef | sequential | 0.375 | 50.0 (40.0) | 0.75 | – | 0 | – | 25.0 |"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("Against the truth"), std::string::npos);
  EXPECT_EQ(text.find("Held-out"), std::string::npos);
}

TEST(DensifyTablesTest, OnlyAgainstItsOwnSetAndBaseline) {
  std::vector<DensifyRow> rows = Rows();
  rows[0].set = "wreck";
  rows.push_back(MakeRow("complete_all", 8, 1000));
  const std::string text = DensifyTables({rows, {}, {}});
  EXPECT_NE(text.find("| reef | sequential | 8 | 16.0 | 4 | 3.00 | – |"), std::string::npos);
  EXPECT_EQ(text.find("Where the saving"), std::string::npos);
}

TEST(DensifyTablesTest, CompletionTruthProgramAndHoldOut) {
  std::vector<DensifyRow> rows = {MakeRow("complete_all", 8, 1000), MakeRow("all", 2, 250)};
  rows[1].completion_pairs = 3;
  rows[0].coverage_4gsd = 0.8;
  rows[1].coverage_4gsd = 0.6;
  rows[1].within_1gsd = 0.5;
  rows[1].within_2gsd = 0.75;
  rows[1].within_4gsd = 0.875;
  HoldOutRow held;
  held.set = "cave";
  held.variant = "all";
  held.points = 100;
  held.held = 20;
  held.eligible = 10;
  held.passed = 0.5;
  ProgramRow program;
  program.set = "mole";
  program.cpu = 3;
  program.decode_cpu = 2;
  program.megapixels = 10;
  const std::string text = DensifyTables({rows, {held}, {program}});
  EXPECT_NE(text.find("| reef | all | 8 | 16.0 | 1 + 3 | 2.00 | 0.250 |"), std::string::npos);
  EXPECT_NE(text.find("| reef | all | 50.0 | 75.00 | 87.50 | – | – | 60.00 | 0.7500 | – |"),
            std::string::npos)
      << text;
  EXPECT_EQ(text.find("| reef | complete_all | –"), std::string::npos);
  EXPECT_NE(text.find("| cave | all | 100 | 20 | 10 | 50.0 | – | – | – | – | – | – |"),
            std::string::npos)
      << text;
  // Every cell has its title.
  const size_t head = text.find("| set", text.find("Held-out"));
  const std::string titles = text.substr(head, text.find('\n', head) - head);
  EXPECT_EQ(std::count(titles.begin(), titles.end(), '|'), 13) << titles;
  EXPECT_NE(
      text.find("| mole | 0 | 10.0 | 3.00 | 0.00 | 2.00 | 1.50 | 0.00 | 0.3000 | 0 | default"),
      std::string::npos)
      << text;
}

TEST(DensifyTablesTest, PlotDataHasALineASet) {
  std::vector<DensifyRow> rows = {Rows()[1]};
  const std::string text = DensifyPlotData(rows);
  EXPECT_EQ(text.substr(0, text.find('\t', 4)), "set\tcpu complete");
  EXPECT_EQ(text.substr(text.find('\n')),
            "\nreef\t?\t?\t?\t?\t?\t0.1875\t0.75\t?\t1.5\t?\t?\t?\t?\t?\t?\t?\t?\t?\t?\t?\n");
}

TEST(DensifyRowsTest, RoundTripAndDamage) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "densify.csv";
  WriteDensifyRows(path, Rows());
  const std::vector<DensifyRow> read = ReadDensifyRows(path);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].variant, "sequential");
  EXPECT_EQ(read[1].cpu, 3);
  EXPECT_EQ(read[1].seeds_kept, 0.25);
  EXPECT_TRUE(std::isnan(read[1].coverage_4gsd));
  EXPECT_THROW(ReadHoldOutRows(path), Error);
  EXPECT_THROW(ReadProgramRows(path), Error);
  EXPECT_THROW(ReadDensifyRows(path.string() + ".missing"), Error);
  EXPECT_THROW(FindVariant("total"), UsageError);
  for (const DensifyVariant& variant : kDensifyVariants) {
    if (variant.baseline != nullptr) {
      EXPECT_EQ(std::string(FindVariant(variant.baseline).mode), "complete");
      EXPECT_EQ(std::string(FindVariant(variant.baseline).redundancy), variant.redundancy);
    }
  }
}

}  // namespace
}  // namespace colmap_seapoint
