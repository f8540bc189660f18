// automatic_reconstructor with a stand-in for COLMAP.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class Reconstructor : public testing::Test {
 protected:
  void SetUp() override { WriteStrip(folder_ / "images", 6); }

  fs::path Workspace() const { return folder_ / "workspace"; }

  CliResult Reconstruct(const std::string& mode, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"automatic_reconstructor",
                                          "--image_path",
                                          (folder_ / "images").string(),
                                          "--workspace_path",
                                          Workspace().string(),
                                          "--colmap_path",
                                          FAKE_COLMAP};
    arguments.insert(arguments.end(), more.begin(), more.end());
    CliOptions options;
    options.environment["FAKE_COLMAP_MODE"] = mode;
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }

  nlohmann::json Report() const {
    return nlohmann::json::parse(ReadBytes(Workspace() / "report" / "run.json"));
  }

  TemporaryFolder folder_;
};

TEST_F(Reconstructor, RunsTheWholeChain) {
  const CliResult result = Reconstruct("model");
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  for (const char* file : {"database.db",
                           "sparse/0/images.bin",
                           "dense/0/fused.ply",
                           "dense/0/fused.ply.vis",
                           "dense/0/pairs.csv",
                           "dense/0/run.json",
                           "map/0/orthomosaic.tif",
                           "map/0/dem.tif",
                           "map/0/source.tif",
                           "map/0/hillshade.png",
                           "map/0/orthomosaic.jpg",
                           "map/0/map.json",
                           "report/summary.txt",
                           "report/run.json",
                           "report/index.html",
                           "report/completeness/0/index.html",
                           "report/completeness/0/completeness.json",
                           "report/completeness/0/gaps.geojson",
                           "report/completeness/0/map.png",
                           "report/mapper_1_thinned.log"}) {
    EXPECT_TRUE(fs::exists(Workspace() / file)) << file;
  }
  EXPECT_FALSE(fs::exists(Workspace() / "sparse.tmp"));
  EXPECT_NE(result.out.find((Workspace() / "dense/0/fused.ply").string()), std::string::npos);
  const nlohmann::json report = Report();
  EXPECT_EQ(report["images_in"], 6);
  EXPECT_EQ(report["images_used"], 6);
  EXPECT_EQ(report["left_out"].size(), 0u);
  EXPECT_EQ(report["inputs"].size(), 6u);
  std::set<std::string> stages;
  for (const auto& stage : report["stages"]) stages.insert(stage["name"]);
  EXPECT_EQ(stages, (std::set<std::string>{"feature_extractor", "exhaustive_matcher", "mapper",
                                           "partial_densifier 0", "orthomosaic 0",
                                           "completeness_reporter 0"}));
  EXPECT_NE(result.out.find("map in " + (Workspace() / "map/0").string()), std::string::npos);
  EXPECT_NE(result.out.find("% (+- "), std::string::npos) << result.Text();
  // Again: the answer is remembered; without it: what was there goes.
  const CliResult again = Reconstruct("model");
  EXPECT_NE(again.out.find("% (+- "), std::string::npos) << again.Text();
  EXPECT_NE(again.err.find("completeness/0 is there already"), std::string::npos) << again.Text();
  const CliResult without = Reconstruct("model", {"--completeness", "0"});
  EXPECT_EQ(without.out.find("% (+- "), std::string::npos) << without.Text();
  EXPECT_FALSE(fs::exists(Workspace() / "report/completeness/0"));
}

TEST_F(Reconstructor, MapZeroMakesNoneAndRemovesThoseOfEarlierRuns) {
  CliResult result = Reconstruct("model", {"--map", "0"});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_FALSE(fs::exists(Workspace() / "map"));
  EXPECT_EQ(result.out.find("map in "), std::string::npos);
  result = Reconstruct("model", {"--Orthomosaic.pixel_size", "0.02"});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(Report()["options"]["Orthomosaic.pixel_size"], "0.02");
  const auto written = fs::last_write_time(Workspace() / "map/0/orthomosaic.tif");
  result = Reconstruct("model", {"--Orthomosaic.pixel_size", "0.02"});
  EXPECT_NE(result.err.find("map/0 is there already"), std::string::npos) << result.Text();
  EXPECT_EQ(fs::last_write_time(Workspace() / "map/0/orthomosaic.tif"), written);
  // Another option: the map alone is made again.
  result = Reconstruct("model", {"--Orthomosaic.pixel_size", "0.03"});
  EXPECT_NE(result.err.find("dense/0 is there already"), std::string::npos) << result.Text();
  EXPECT_NE(fs::last_write_time(Workspace() / "map/0/orthomosaic.tif"), written);
  EXPECT_EQ(Reconstruct("model", {"--Orthomosaic.up", "1"}).exit_code, 2);
  ASSERT_EQ(Reconstruct("model", {"--map", "0"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(Workspace() / "map"));
}

// The cloud is there, and no map can be made of it: that is said, and is no failure.
TEST_F(Reconstructor, AModelWithoutAMapIsNamed) {
  const CliResult result = Reconstruct("model", {"--Orthomosaic.pixel_size", "1e-9"});
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  EXPECT_NE(result.out.find("left out: map of sparse/0: the map: would be of"), std::string::npos)
      << result.Text();
  EXPECT_TRUE(fs::exists(Workspace() / "dense/0/fused.ply"));
  EXPECT_FALSE(fs::exists(Workspace() / "map/0"));
  EXPECT_EQ(Reconstruct("model").exit_code, 0);
  EXPECT_TRUE(fs::exists(Workspace() / "map/0/orthomosaic.tif"));
}

TEST_F(Reconstructor, NoColmapIsSaidBeforeAnyWork) {
  CliOptions options;
  options.environment["PATH"] = folder_.Path().string();
  const std::vector<std::string> arguments = {"automatic_reconstructor", "--image_path",
                                              (folder_ / "images").string(), "--workspace_path",
                                              Workspace().string()};
  CliResult result = RunProgram(SEAPOINT_PROGRAM, arguments, options);
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("--colmap_path"), std::string::npos) << result.Text();
  EXPECT_FALSE(fs::exists(Workspace()));
  // A program of that name which is not COLMAP.
  fs::create_symlink("/bin/false", folder_ / "colmap");
  result = RunProgram(SEAPOINT_PROGRAM, arguments, options);
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("--colmap_path"), std::string::npos) << result.Text();
  EXPECT_FALSE(fs::exists(Workspace()));
}

TEST_F(Reconstructor, MapperOptionsAreHandedOnOrRefused) {
  CliResult result = Reconstruct("model", {"--Mapper.min_model_sice", "3"});
  EXPECT_EQ(result.exit_code, 2) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("Mapper.min_model_sice"), std::string::npos);
  EXPECT_FALSE(fs::exists(Workspace()));
  result = Reconstruct("model", {"--Mapper.min_model_size", "4"});
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(Report()["options"]["Mapper.min_model_size"], "4");
}

TEST_F(Reconstructor, FieldQualityTakesTheGlobalMapperThatFindsAll) {
  ASSERT_EQ(Reconstruct("global", {"--quality", "field"}).exit_code, 0);
  EXPECT_EQ(Report()["images_used"], 6);
  EXPECT_TRUE(fs::exists(Workspace() / "report/mapper_1_global.log"));
  EXPECT_FALSE(fs::exists(Workspace() / "report/mapper_1_thinned.log"));
}

TEST_F(Reconstructor, WhatTheGlobalMapperLeavesOutTheOtherMayFind) {
  ASSERT_EQ(Reconstruct("global_partial", {"--quality", "field"}).exit_code, 0);
  EXPECT_EQ(Report()["images_used"], 6);
  EXPECT_TRUE(fs::exists(Workspace() / "report/mapper_1_global.log"));
  EXPECT_TRUE(fs::exists(Workspace() / "report/mapper_1_thinned.log"));
}

TEST_F(Reconstructor, QualityPresetsWhatIsNotGiven) {
  EXPECT_EQ(Reconstruct("model", {"--quality", "best"}).exit_code, 2);
  ASSERT_EQ(Reconstruct("model", {"--SeaPointExtraction.max_num_features", "700", "--quality",
                                  "archive", "--SeaPointExtraction.min_num_features", "600"})
                .exit_code,
            0);
  const auto options = Report()["options"];
  EXPECT_EQ(options["quality"], "archive");
  EXPECT_EQ(options["SeaPointExtraction.descriptor"], "sift");
  EXPECT_EQ(options["SeaPointExtraction.min_num_features"], "600");
  EXPECT_EQ(options["SeaPointExtraction.max_num_features"], "700");
}

TEST_F(Reconstructor, AMapperThatFindsNoModel) {
  CliResult result = Reconstruct("no_model");
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("found no model"), std::string::npos) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("mapper_1.log"), std::string::npos) << result.Text();
  EXPECT_FALSE(fs::exists(Workspace() / "sparse"));
  // Without the cause, the same command goes on from there.
  result = Reconstruct("model");
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.err.find("6 pictures were there already"), std::string::npos) << result.Text();
}

TEST_F(Reconstructor, AMapperThatCrashes) {
  const CliResult result = Reconstruct("crash");
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("signal 6"), std::string::npos) << result.Text();
  EXPECT_FALSE(fs::exists(Workspace() / "sparse"));
  EXPECT_EQ(Reconstruct("model").exit_code, 0);
  EXPECT_FALSE(fs::exists(Workspace() / "sparse.tmp"));
}

TEST_F(Reconstructor, PicturesInNoModelAreNamed) {
  const CliResult result = Reconstruct("partial");
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  const nlohmann::json report = Report();
  ASSERT_EQ(report["left_out"].size(), 1u);
  EXPECT_EQ(report["left_out"][0]["name"], "img6.png");
  EXPECT_EQ(report["images_used"], 5);
  EXPECT_NE(result.out.find("left out: img6.png"), std::string::npos) << result.Text();
  // Resuming says the same.
  EXPECT_EQ(Reconstruct("partial").exit_code, 3);
  EXPECT_TRUE(Report()["left_out"] == report["left_out"]);
}

TEST_F(Reconstructor, EveryModelBecomesACloud) {
  ASSERT_EQ(Reconstruct("two_models", {"--join_models", "0"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(Workspace() / "dense/0/fused.ply"));
  EXPECT_TRUE(fs::exists(Workspace() / "dense/1/fused.ply"));
  EXPECT_TRUE(fs::exists(Workspace() / "map/1/orthomosaic.tif"));
  // When a later run finds one model only, the second cloud does not stay behind.
  ASSERT_EQ(Reconstruct("model", {"--Mapper.min_model_size", "4"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(Workspace() / "dense/0/fused.ply"));
  EXPECT_FALSE(fs::exists(Workspace() / "dense/1"));
  EXPECT_TRUE(fs::exists(Workspace() / "map/0/orthomosaic.tif"));
  EXPECT_FALSE(fs::exists(Workspace() / "map/1"));
}

TEST_F(Reconstructor, WhatTheFirstRoundLeavesOverGetsItsOwn) {
  const CliResult result = Reconstruct("two_rounds", {"--join_models", "0"});
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(ReadSparseModel(Workspace() / "sparse/0").images.size(), 3u);
  EXPECT_EQ(ReadSparseModel(Workspace() / "sparse/1").images.size(), 3u);
  EXPECT_TRUE(fs::exists(Workspace() / "dense/1/fused.ply"));
  EXPECT_EQ(Report()["images_used"], 6);
}

TEST_F(Reconstructor, BadPicturesAreLeftOutOfTheChain) {
  WriteBytes(folder_ / "images" / "zero.png", "");
  WriteImage(folder_ / "images" / "flat.png", ColorImage(kStripWidth, kStripHeight, 3, 90));
  const CliResult result = Reconstruct("model");
  EXPECT_EQ(result.exit_code, 3) << result.Text();
  std::set<std::string> names;
  const nlohmann::json report = Report();
  for (const auto& item : report["left_out"]) names.insert(item["name"]);
  EXPECT_EQ(names, (std::set<std::string>{"flat.png", "zero.png"}));
  EXPECT_EQ(report["left_out"].size(), 2u);
  EXPECT_EQ(report["images_in"], 8);
  EXPECT_EQ(report["images_used"], 6);
}

TEST_F(Reconstructor, PicturesThatShareNothing) {
  fs::remove_all(folder_ / "images");
  fs::create_directories(folder_ / "images");
  WriteImage(folder_ / "images" / "a.png", StripPicture(1));
  WriteImage(folder_ / "images" / "b.png", StripPicture(20));
  const CliResult result = Reconstruct("model");
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("same place"), std::string::npos) << result.Text();
}

TEST_F(Reconstructor, AForeignDatabaseIsNotTouched) {
  WriteBytes(Workspace() / "database.db", "somebody's work");
  const CliResult result = Reconstruct("model");
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("--workspace_path"), std::string::npos) << result.Text();
  EXPECT_EQ(ReadBytes(Workspace() / "database.db"), "somebody's work");
}

}  // namespace
}  // namespace colmap_seapoint
