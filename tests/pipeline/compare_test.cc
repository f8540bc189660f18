#include "colmap_seapoint/pipeline/compare.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "colmap_seapoint/io/cloud/ply.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class Compare : public testing::Test {
 protected:
  // A lattice of 20 x 20 points one apart, raised by a quarter, against a lattice of 40 x 40.
  void SetUp() override {
    WriteLattice("a.ply", 20, 0.25f);
    WriteLattice("b.ply", 40, 0);
  }

  void WriteLattice(const std::string& name, int side, float height) const {
    CloudWriter writer(folder_ / name);
    for (int i = 0; i < side * side; ++i) {
      const CloudPoint point = {
          {static_cast<float>(i % side), static_cast<float>(i / side), height}, {0, 0, 1}, {}};
      writer.Add(point, nullptr, 0);
    }
    writer.Finish();
  }

  CloudComparerOptions Options(const std::string& distances = "0.2,0.5") const {
    CloudComparerOptions options;
    options.input_path = (folder_ / "a.ply").string();
    options.reference_path = (folder_ / "b.ply").string();
    options.output_path = (folder_ / "out/result.json").string();
    options.distances = distances;
    return options;
  }
  nlohmann::json Json() const {
    return nlohmann::json::parse(ReadBytes(folder_ / "out/result.json"));
  }

  TemporaryFolder folder_;
};

TEST_F(Compare, WritesFiguresAndATable) {
  const CommandResult result = RunCloudComparer(Options());
  EXPECT_TRUE(result.is_complete);
  EXPECT_NE(result.text.find("ETH3D"), std::string::npos) << result.text;
  const nlohmann::json json = Json();
  EXPECT_EQ(json["input"]["points"], 400);
  EXPECT_EQ(json["reference"]["points"], 1600);
  EXPECT_EQ(json["points"]["at"][0]["accuracy"], 0);
  EXPECT_EQ(json["points"]["at"][1]["accuracy"], 1);
  EXPECT_EQ(json["points"]["at"][1]["completeness"], 0.25);
  EXPECT_EQ(json["distance"]["input_to_reference"]["median"], 0.25);
}

TEST_F(Compare, WithoutDistancesTheyComeFromTheSpacing) {
  RunCloudComparer(Options(""));
  ASSERT_EQ(Json()["points"]["at"].size(), 3u);
  EXPECT_EQ(Json()["points"]["at"][0]["distance"], 1);
  EXPECT_EQ(Json()["points"]["at"][2]["distance"], 4);
}

TEST_F(Compare, MetresGiveDensitiesPerSquareCentimetre) {
  CloudComparerOptions options = Options();
  EXPECT_EQ(RunCloudComparer(options).text.find("per cm^2"), std::string::npos);
  options.unit_in_metres = true;
  EXPECT_NE(RunCloudComparer(options).text.find("per cm^2"), std::string::npos);
}

TEST_F(Compare, DifferencesAreWrittenWhereTheyAreAskedFor) {
  RunCloudComparer(Options());
  EXPECT_EQ(ReadTree(folder_ / "out").size(), 1u);
  CloudComparerOptions options = Options();
  options.difference_path = (folder_ / "differences").string();
  RunCloudComparer(options);
  std::set<std::string> names;
  for (const auto& [name, bytes] : ReadTree(folder_ / "differences")) names.insert(name);
  EXPECT_EQ(names, (std::set<std::string>{".colmap_seapoint", "differences.png",
                                          "input_to_reference.ply", "reference_to_input.ply"}));
  EXPECT_EQ(ReadCloud(folder_ / "differences/input_to_reference.ply").size(), 400u);
}

TEST_F(Compare, TheSameFiguresForAnyNumberOfThreads) {
  CloudComparerOptions options = Options();
  options.run.num_threads = 1;
  RunCloudComparer(options);
  const std::string one = ReadBytes(folder_ / "out/result.json");
  options.run.num_threads = 3;
  RunCloudComparer(options);
  EXPECT_EQ(ReadBytes(folder_ / "out/result.json"), one);
}

TEST_F(Compare, DistancesAreCheckedBeforeTheWork) {
  for (const char* distances : {"0", "-1", "1,1", "2,1", "1,", ",1", ",", "one", "1 m", "nan",
                                "inf", "1e999", "1,2,3,4,5,6,7,8,9"}) {
    EXPECT_USAGE_ERROR(RunCloudComparer(Options(distances)),
                       std::string("--distances ") + distances);
  }
  CloudComparerOptions options = Options("1,2");
  options.compare.max_distance = 1.5;
  EXPECT_USAGE_ERROR(RunCloudComparer(options), "--max_distance");
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  options.compare.max_distance = 2;
  EXPECT_TRUE(RunCloudComparer(options).is_complete);
}

TEST_F(Compare, BadCloudsAreNamed) {
  WriteBytes(folder_ / "b.ply", "no cloud");
  EXPECT_ERROR(RunCloudComparer(Options()), "b.ply");
  fs::remove(folder_ / "a.ply");
  EXPECT_ERROR(RunCloudComparer(Options()), "a.ply");
  EXPECT_FALSE(fs::exists(folder_ / "out/result.json"));
}

}  // namespace
}  // namespace colmap_seapoint
