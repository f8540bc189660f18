#include "colmap_seapoint/pipeline/reconstruct.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "colmap_seapoint/io/colmap/colmap_model.h"
#include "colmap_seapoint/io/image/image_file.h"
#include "colmap_seapoint/workspace/stage_runner.h"
#include "tests/cli/database_tables.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class Reconstruct : public StripSurvey {
 protected:
  void SetUp() override { WritePictures(4); }

  fs::path Root() const { return folder_ / "ws"; }
  nlohmann::json Report() const {
    return nlohmann::json::parse(ReadBytes(Root() / "report/run.json"));
  }
  Names StageNames() const {
    Names names;
    const nlohmann::json report = Report();
    for (const auto& stage : report["stages"]) names.push_back(stage["name"]);
    return names;
  }
  // What the untied pictures were found to be.
  std::set<std::string> SecondChance() const {
    const auto record = nlohmann::json::parse(ReadBytes(Root() / "state/second_chance.json"));
    return record["result"]["untied"].get<std::set<std::string>>();
  }
};

TEST_F(Reconstruct, OneStageAfterTheOther) {
  const CommandResult result = RunAutomaticReconstructor(ReconstructorOptions());
  EXPECT_TRUE(result.is_complete);
  EXPECT_EQ(StageNames(),
            (Names{"feature_extractor", "exhaustive_matcher", "mapper", "partial_densifier 0",
                   "orthomosaic 0", "completeness_reporter 0"}));
  for (const char* stage :
       {"database", "second_chance", "mapper", "dense_0", "map_0", "completeness_0"}) {
    EXPECT_TRUE(fs::exists(Root() / "state" / (std::string(stage) + ".json"))) << stage;
  }
  const nlohmann::json report = Report();
  EXPECT_EQ(report["images_in"], 4);
  EXPECT_EQ(report["images_used"], 4);
  EXPECT_EQ(report["inputs"].size(), 4u);
  EXPECT_EQ(report["units"], "arbitrary");
  EXPECT_GT(report["points"], 0);
  EXPECT_EQ(result.text.rfind("4 of 4 pictures used, 1 model, ", 0), 0u) << result.text;
  EXPECT_NE(result.text.find("report: " + (Root() / "report").string() + "\n"), std::string::npos);
  EXPECT_EQ(result.text.find(ReadBytes(Root() / "report/summary.txt")), 0u);
}

TEST_F(Reconstruct, AgainIsTheSameWithoutTheWork) {
  RunAutomaticReconstructor(ReconstructorOptions());
  const auto models = ReadTree(Root() / "sparse"), clouds = ReadTree(Root() / "dense");
  const auto rows = ReadTables(Root() / "database.db");
  const FakeColmapMode crash("crash");  // it is not even asked
  std::string log = LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); });
  for (const char* part : {"4 pictures were there already", "6 pairs were there already",
                           "The models in", "The cloud in"}) {
    EXPECT_NE(log.find(part), std::string::npos) << part << log;
  }
  EXPECT_TRUE(ReadTree(Root() / "sparse") == models);
  EXPECT_TRUE(ReadTree(Root() / "dense") == clouds);
  EXPECT_TRUE(ReadTables(Root() / "database.db") == rows);
}

TEST_F(Reconstruct, PicturesThatComeInAreAddedToTheModel) {
  const FakeColmapMode continues("continues");
  RunAutomaticReconstructor(ReconstructorOptions());
  const SparseModel before = ReadSparseModel(Root() / "sparse/0");
  const auto matches = QueryRows(Root() / "database.db", "SELECT pair_id, data FROM matches");
  WritePictures(6);
  const std::string log = LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); });
  EXPECT_NE(log.find("2 pictures added to the 4 that were there"), std::string::npos) << log;
  const SparseModel after = ReadSparseModel(Root() / "sparse/0");
  ASSERT_EQ(after.images.size(), 6u);
  for (size_t i = 0; i < before.images.size(); ++i) {
    EXPECT_EQ(after.images[i].name, before.images[i].name);
    EXPECT_EQ(after.images[i].cam_from_world.translation,
              before.images[i].cam_from_world.translation);
  }
  const auto more = QueryRows(Root() / "database.db", "SELECT pair_id, data FROM matches");
  EXPECT_EQ(more.size(), 15u);
  for (const auto& row : matches) {
    EXPECT_NE(std::find(more.begin(), more.end(), row), more.end());
  }
  // And once more is nothing to do; a model that was tampered with is not continued.
  EXPECT_NE(LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); }).find("The models in"),
            std::string::npos);
  WriteSparseModelBinary(Root() / "sparse/0", before);
  const std::string anew = LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); });
  EXPECT_EQ(anew.find("pictures added to"), std::string::npos) << anew;
  EXPECT_EQ(ReadSparseModel(Root() / "sparse/0").images.size(), 6u);
}

TEST_F(Reconstruct, AFewPicturesAreNotWhatManyAreAddedTo) {
  const FakeColmapMode continues("continues");
  RunAutomaticReconstructor(ReconstructorOptions());
  WritePictures(9);
  const std::string log = LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); });
  EXPECT_EQ(log.find("pictures added to"), std::string::npos) << log;
  EXPECT_EQ(ReadSparseModel(Root() / "sparse/0").images.size(), 9u);
}

// What four pictures told of the lens is not held for seventeen, by however many steps they came.
TEST_F(Reconstruct, AModelThatHasGrownFourfoldIsMappedAnew) {
  const FakeColmapMode continues("continues");
  AutomaticReconstructorOptions options = ReconstructorOptions();
  options.report_completeness = options.makes_map = false;
  RunAutomaticReconstructor(options);
  for (const int count : {8, 16}) {
    WritePictures(count);
    const std::string log = LogOf([&] { RunAutomaticReconstructor(options); });
    EXPECT_NE(log.find("pictures added to"), std::string::npos) << log;
  }
  WritePictures(17);
  const std::string log = LogOf([&] { RunAutomaticReconstructor(options); });
  EXPECT_EQ(log.find("pictures added to"), std::string::npos) << log;
  EXPECT_EQ(ReadSparseModel(Root() / "sparse/0").images.size(), 17u);
}

TEST_F(Reconstruct, TheMatcherIsChosenByTheNumberOfPicturesOrTheUser) {
  AutomaticReconstructorOptions options = ReconstructorOptions();
  options.matcher = "sequential";
  options.pairs.loop_detection = false;
  options.pairs.overlap = 1;
  RunAutomaticReconstructor(options);
  EXPECT_EQ(StageNames()[1], "sequential_matcher");
  EXPECT_EQ(QueryRows(Root() / "database.db", "SELECT pair_id FROM matches").size(), 3u);
  // The other one begins the database anew.
  options.matcher = "exhaustive";
  RunAutomaticReconstructor(options);
  EXPECT_EQ(StageNames()[1], "exhaustive_matcher");
  EXPECT_EQ(QueryRows(Root() / "database.db", "SELECT pair_id FROM matches").size(), 6u);
}

TEST_F(Reconstruct, UntiedPicturesGetASecondChanceOnce) {
  WriteImage(Images() / "img9.png", StripPicture(20));  // shows nothing of the others
  std::string log = LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); });
  EXPECT_NE(log.find("5 pictures are untied, or may tie one that is"), std::string::npos) << log;
  // All of a small set were tried with it.
  EXPECT_EQ(SecondChance(),
            (std::set<std::string>{"img1.png", "img2.png", "img3.png", "img4.png", "img9.png"}));
  const auto rows = ReadTables(Root() / "database.db");
  // The two passes of the first run are one pass of the next.
  log = LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); });
  EXPECT_EQ(log.find("are untied"), std::string::npos) << log;
  EXPECT_NE(log.find("5 pictures were there already"), std::string::npos) << log;
  EXPECT_TRUE(ReadTables(Root() / "database.db") == rows);
  // A changed picture is looked at again.
  WriteImage(Images() / "img9.png", StripPicture(5));
  log = LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); });
  EXPECT_EQ(log.find("are untied"), std::string::npos) << log;
  EXPECT_EQ(SecondChance(), std::set<std::string>());
}

// As one of the deck: it is in no model, and nothing else changes.
TEST_F(Reconstruct, APictureThatNothingTiesChangesNoOther) {
  const FakeColmapMode continues("continues");
  RunAutomaticReconstructor(ReconstructorOptions());
  const auto models = ReadTree(Root() / "sparse"), clouds = ReadTree(Root() / "dense");
  const auto rows = QueryRows(Root() / "database.db", "SELECT image_id, data FROM keypoints");
  const auto matches = QueryRows(Root() / "database.db", "SELECT pair_id, data FROM matches");
  WriteImage(Images() / "img9.png", StripPicture(20));
  const std::string log = LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); });
  EXPECT_NE(log.find("Nothing ties them"), std::string::npos) << log;
  EXPECT_NE(log.find("nothing ties the new pictures to the 4"), std::string::npos) << log;
  EXPECT_TRUE(ReadTree(Root() / "sparse") == models);
  EXPECT_TRUE(ReadBytes(Root() / "dense/0/fused.ply") == clouds.at("0/fused.ply"));
  const auto contains = [](const auto& all, const auto& part) {
    return std::all_of(part.begin(), part.end(), [&](const auto& row) {
      return std::find(all.begin(), all.end(), row) != all.end();
    });
  };
  EXPECT_TRUE(
      contains(QueryRows(Root() / "database.db", "SELECT image_id, data FROM keypoints"), rows));
  EXPECT_TRUE(
      contains(QueryRows(Root() / "database.db", "SELECT pair_id, data FROM matches"), matches));
  const std::string again = LogOf([&] { RunAutomaticReconstructor(ReconstructorOptions()); });
  EXPECT_EQ(again.find("are untied"), std::string::npos) << again;
  EXPECT_NE(again.find("The models in"), std::string::npos) << again;
}

TEST_F(Reconstruct, PicturesWithAllLevelsNeedNoSecondChance) {
  WriteImage(Images() / "img9.png", StripPicture(20));
  AutomaticReconstructorOptions options = ReconstructorOptions();
  options.extraction.num_levels = 2;
  const std::string log = LogOf([&] { RunAutomaticReconstructor(options); });
  EXPECT_EQ(log.find("are untied"), std::string::npos) << log;
  EXPECT_FALSE(fs::exists(Root() / "state/second_chance.json"));
}

TEST_F(Reconstruct, WhatIsInNoModelIsLeftOut) {
  const FakeColmapMode partial("partial");
  const CommandResult result = RunAutomaticReconstructor(ReconstructorOptions());
  EXPECT_FALSE(result.is_complete);
  const nlohmann::json report = Report();
  ASSERT_EQ(report["left_out"].size(), 1u);
  EXPECT_EQ(report["left_out"][0]["name"], "img4.png");
  EXPECT_EQ(report["images_used"], 3);
  EXPECT_NE(result.text.find("left out: img4.png: is in no model"), std::string::npos)
      << result.text;
}

TEST_F(Reconstruct, ScalesWhereItIsTold) {
  AutomaticReconstructorOptions options = ReconstructorOptions();
  options.scale.positions_path =
      Write("positions.csv",
            "image,x,y,z\nimg1.png,0,0,0\nimg2.png,1,0,0\nimg3.png,2,0,0\n"
            "img4.png,3,0,0\n");
  const CommandResult result = RunAutomaticReconstructor(options);
  EXPECT_EQ(Report()["units"], "metres");
  EXPECT_EQ(StageNames()[3], "model_scaler 0");
  EXPECT_TRUE(fs::exists(Root() / "sparse_scaled/0/units.json"));
  EXPECT_NE(result.text.find("metres, local (scale "), std::string::npos) << result.text;
}

TEST_F(Reconstruct, MistakesAreSeenBeforeAnythingIsWritten) {
  AutomaticReconstructorOptions options = ReconstructorOptions();
  options.mapper["Mapper.no_such_option"] = "1";
  EXPECT_USAGE_ERROR(RunAutomaticReconstructor(options), "Mapper.no_such_option");
  options = ReconstructorOptions();
  options.colmap_path = "no_such_colmap";
  EXPECT_ERROR(RunAutomaticReconstructor(options), "--colmap_path");
  options = ReconstructorOptions();
  options.image_path = (folder_ / "absent").string();
  EXPECT_ERROR(RunAutomaticReconstructor(options), "absent");
  EXPECT_FALSE(fs::exists(Root()));
}

}  // namespace
}  // namespace colmap_seapoint
