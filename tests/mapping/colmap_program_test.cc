#include "colmap_seapoint/mapping/colmap_program.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/io/test_files.h"
#include "tests/mapping/scripted_colmap.h"

namespace colmap_seapoint {
namespace {

// Some of what "colmap mapper -h" lists: names that only one of the versions has, and common ones.
const std::vector<std::string> kOptionsOf3 = {"random_seed",
                                              "Mapper.num_threads",
                                              "Mapper.min_model_size",
                                              "Mapper.init_min_num_inliers",
                                              "Mapper.abs_pose_min_num_inliers",
                                              "Mapper.ba_global_images_ratio",
                                              "Mapper.ba_global_max_num_iterations",
                                              "Mapper.ba_local_num_images"};
const std::vector<std::string> kOptionsOf4 = {"default_random_seed",
                                              "Mapper.random_seed",
                                              "Mapper.num_threads",
                                              "Mapper.min_model_size",
                                              "Mapper.init_min_num_inliers",
                                              "Mapper.abs_pose_min_num_inliers",
                                              "Mapper.ba_global_frames_ratio",
                                              "Mapper.ba_global_max_num_iterations",
                                              "Mapper.ba_local_num_images"};

class ColmapProgramTest : public testing::Test {
 protected:
  void SetVersion3() { colmap_.SetHelp(MapperHelp("COLMAP 3.8 (Commit x)", kOptionsOf3)); }
  void SetVersion4() {
    colmap_.SetHelp(MapperHelp("COLMAP 4.0.1 (Commit y)", kOptionsOf4),
                    "Available commands:\n  global_mapper\n  mapper\n",
                    "  --GlobalMapper.num_threads arg (=-1)\n"
                    "  --GlobalMapper.random_seed arg (=-1)\n");
  }

  TempDir dir_;
  ScriptedColmap colmap_{dir_.Path()};
};

TEST_F(ColmapProgramTest, AsksForVersionAndOptions) {
  SetVersion3();
  const ColmapProgram colmap = colmap_.Program();
  EXPECT_EQ(colmap.path, colmap_.Path());
  EXPECT_EQ(colmap.version, "COLMAP 3.8 (Commit x)");
  EXPECT_FALSE(colmap.has_global_mapper);
  EXPECT_TRUE(std::is_sorted(colmap.mapper_options.begin(), colmap.mapper_options.end()));
  for (const std::string& name : kOptionsOf3) EXPECT_TRUE(colmap.HasMapperOption(name)) << name;
  EXPECT_TRUE(colmap.HasMapperOption("database_path"));
  // A name is no option for being the beginning of one, nor a line of text for holding "--".
  EXPECT_FALSE(colmap.HasMapperOption("Mapper.min_model"));
  EXPECT_FALSE(colmap.HasMapperOption("help ]"));
  EXPECT_FALSE(colmap.HasMapperOption("Mapper.random_seed"));
}

// What differs between two versions must differ here, and what does not, the time of the answer,
// must not: by this a mapping is known to be another one's.
TEST_F(ColmapProgramTest, TheVersionIsReadFromALogLineToo) {
  colmap_.SetHelp(
      MapperHelp("I20261129 07:26:52.421883 17465 option_manager.cc:1319] COLMAP 4.2.1 (Commit z)",
                 kOptionsOf4));
  EXPECT_EQ(colmap_.Program().version, "COLMAP 4.2.1 (Commit z)");
}

TEST_F(ColmapProgramTest, ItsLogGoesToUsAndNotToAFileOfItsOwn) {
  std::vector<std::string> options = kOptionsOf4;
  options.emplace_back("log_target");
  colmap_.SetHelp(MapperHelp("COLMAP 4.2.1 (Commit z)", options),
                  "Available commands:\n  global_mapper\n  mapper\n");
  const ColmapProgram colmap = colmap_.Program();
  EXPECT_EQ(OptionsOfRound(colmap, Round::kLater, "field", 5, {}).at("log_target"), "stderr");
  EXPECT_EQ(OptionsOfGlobalMapper(colmap, 5)->at("log_target"), "stderr");
}

TEST_F(ColmapProgramTest, KnowsTheOptionsOfTheGlobalMapperWhereThereIsOne) {
  SetVersion4();
  const ColmapProgram colmap = colmap_.Program();
  EXPECT_TRUE(colmap.has_global_mapper);
  EXPECT_TRUE(colmap.HasMapperOption("GlobalMapper.random_seed"));
  EXPECT_TRUE(colmap.HasMapperOption("Mapper.random_seed"));
  EXPECT_EQ(OptionsOfGlobalMapper(colmap, 7),
            (MapperOptions{{"GlobalMapper.num_threads", "1"}, {"GlobalMapper.random_seed", "7"}}));
  SetVersion3();
  EXPECT_EQ(OptionsOfGlobalMapper(colmap_.Program(), 7), std::nullopt);
}

TEST_F(ColmapProgramTest, WhatIsNoColmapIsRefused) {
  EXPECT_ERROR(FindColmap((dir_ / "nothing").string()), "--colmap_path");
  EXPECT_ERROR(FindColmap("/bin/false"), "does not answer 'mapper -h'");
  EXPECT_ERROR(FindColmap("/bin/true"), "does not answer 'mapper -h'");
  colmap_.SetHelp("usage: something else\n  --output_path arg\n");
  EXPECT_ERROR(colmap_.Program(), "does not answer 'mapper -h'");
}

TEST_F(ColmapProgramTest, OnlyWhatThisVersionKnowsIsHandedOn) {
  SetVersion3();
  EXPECT_EQ(OptionsOfRound(colmap_.Program(), Round::kFirst, "archive", 5, {}),
            (MapperOptions{{"random_seed", "5"},
                           {"Mapper.num_threads", "1"},
                           {"Mapper.min_model_size", "3"},
                           {"Mapper.abs_pose_min_num_inliers", "20"}}));
  SetVersion4();
  EXPECT_EQ(OptionsOfRound(colmap_.Program(), Round::kFirst, "archive", 5, {}),
            (MapperOptions{{"Mapper.random_seed", "5"},
                           {"Mapper.num_threads", "1"},
                           {"Mapper.min_model_size", "3"},
                           {"Mapper.abs_pose_min_num_inliers", "20"}}));
}

TEST_F(ColmapProgramTest, EffortSaysHowOftenModelsAreAdjusted) {
  SetVersion3();
  const ColmapProgram colmap = colmap_.Program();
  const auto of = [&](const std::string& effort, const char* name) {
    const MapperOptions options = OptionsOfRound(colmap, Round::kFirst, effort, 0, {});
    const auto option = options.find(name);
    return option == options.end() ? "" : option->second;
  };
  EXPECT_EQ(of("archive", "Mapper.ba_global_images_ratio"), "");
  EXPECT_EQ(of("survey", "Mapper.ba_global_images_ratio"), "1.4");
  EXPECT_EQ(of("field", "Mapper.ba_global_images_ratio"), "2");
  EXPECT_EQ(of("survey", "Mapper.ba_global_max_num_iterations"), "20");
  EXPECT_EQ(of("field", "Mapper.ba_global_max_num_iterations"), "10");
  EXPECT_EQ(of("survey", "Mapper.ba_local_num_images"), "");
  EXPECT_EQ(of("field", "Mapper.ba_local_num_images"), "4");
}

TEST_F(ColmapProgramTest, LaterRoundsAskForLess) {
  SetVersion3();
  const ColmapProgram colmap = colmap_.Program();
  const MapperOptions first = OptionsOfRound(colmap, Round::kFirst, "survey", 0, {});
  const MapperOptions later = OptionsOfRound(colmap, Round::kLater, "survey", 0, {});
  EXPECT_EQ(first.at("Mapper.abs_pose_min_num_inliers"), "20");
  EXPECT_EQ(first.count("Mapper.init_min_num_inliers"), 0u);
  EXPECT_EQ(later.at("Mapper.abs_pose_min_num_inliers"), "15");
  EXPECT_EQ(later.at("Mapper.init_min_num_inliers"), "50");
}

TEST_F(ColmapProgramTest, TheUsersOptionsWinAndAreChecked) {
  SetVersion3();
  const ColmapProgram colmap = colmap_.Program();
  const MapperOptions users = {{"Mapper.abs_pose_min_num_inliers", "12"},
                               {"Mapper.min_model_size", "5"}};
  const MapperOptions options = OptionsOfRound(colmap, Round::kLater, "field", 0, users);
  EXPECT_EQ(options.at("Mapper.abs_pose_min_num_inliers"), "12");
  EXPECT_EQ(options.at("Mapper.min_model_size"), "5");
  try {
    OptionsOfRound(colmap, Round::kFirst, "field", 0, {{"Mapper.ba_global_frames_ratio", "2"}});
    ADD_FAILURE() << "an option of another version was taken";
  } catch (const UsageError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find("--Mapper.ba_global_frames_ratio 2: "), 0u) << text;
    EXPECT_NE(text.find(colmap.path.string() + " mapper -h"), std::string::npos) << text;
  }
}

TEST(AppendOptionsTest, NameAndValueOfEachBehindWhatIsThere) {
  std::vector<std::string> arguments = {"mapper"};
  AppendOptions({{"b", "2"}, {"a", "1"}}, &arguments);
  EXPECT_EQ(arguments, (std::vector<std::string>{"mapper", "--a", "1", "--b", "2"}));
}

}  // namespace
}  // namespace colmap_seapoint
