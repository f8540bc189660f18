#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

CliResult RunSeaPoint(const std::vector<std::string>& arguments, const CliOptions& options = {}) {
  return RunProgram(SEAPOINT_PROGRAM, arguments, options);
}

const std::vector<std::string> kCommands = {
    "feature_extractor", "sequential_matcher", "exhaustive_matcher",     "spatial_matcher",
    "partial_densifier", "cloud_comparer",     "automatic_reconstructor"};

TEST(Usage, HelpListsEveryCommand) {
  for (const char* word : {"help", "-h", "--help"}) {
    const CliResult result = RunSeaPoint({word});
    EXPECT_EQ(result.exit_code, 0) << result.Text();
    EXPECT_EQ(result.err, "");
    for (const std::string& command : kCommands) {
      EXPECT_NE(result.out.find("  " + command + " "), std::string::npos) << command;
    }
  }
}

TEST(Usage, VersionIsOneLine) {
  const CliResult result = RunSeaPoint({"version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out.find("colmap_seapoint "), 0u);
  EXPECT_EQ(result.out.find('\n'), result.out.size() - 1);
}

TEST(Usage, CameraPresetsAreListed) {
  for (const char* command : {"feature_extractor", "automatic_reconstructor"}) {
    for (const char* word : {"list", "help"}) {
      const CliResult result = RunSeaPoint({command, "--camera_preset", word});
      EXPECT_EQ(result.exit_code, 0) << result.Text();
      EXPECT_EQ(result.err, "");
      EXPECT_NE(result.out.find("\ntg6_flatport "), std::string::npos) << result.out;
    }
  }
  const CliResult unknown = RunSeaPoint({"feature_extractor", "--database_path", "none.db",
                                         "--image_path", ".", "--camera_preset", "tg6"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("--camera_preset tg6: there is no such camera; the nearest are "),
            std::string::npos)
      << unknown.err;
}

TEST(Usage, EveryCommandDescribesItsOptions) {
  for (const std::string& command : kCommands) {
    const CliResult result = RunSeaPoint({command, "-h"});
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_NE(result.out.find("(required)"), std::string::npos) << command;
    EXPECT_NE(result.out.find("--num_threads (=-1)"), std::string::npos) << command;
    EXPECT_NE(result.out.find("--project_path"), std::string::npos) << command;
    size_t begin = 0;
    for (size_t end; (end = result.out.find('\n', begin)) != std::string::npos; begin = end + 1) {
      EXPECT_LE(end - begin, 100u) << result.out.substr(begin, end - begin);
    }
  }
  EXPECT_NE(RunSeaPoint({"feature_extractor", "-h"})
                .out.find("--SeaPointExtraction.min_num_features (=2500)"),
            std::string::npos);
  EXPECT_NE(RunSeaPoint({"automatic_reconstructor", "--help"}).out.find("--Mapper.<option>"),
            std::string::npos);
}

struct WrongUsage {
  std::vector<std::string> arguments;
  std::vector<std::string> words;  // all of them stand in the last line
};

TEST(Usage, MistakesExitWithTwoAndOneSentence) {
  const std::vector<std::string> extract = {"feature_extractor", "--database_path", "d.db",
                                            "--image_path", "i"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), extract.begin(), extract.end());
    return more;
  };
  const std::vector<WrongUsage> cases = {
      {{}, {"no command"}},
      {{"feature_extracter"}, {"feature_extracter", "help"}},
      {{"feature_extractor"}, {"--database_path", "required"}},
      {{"feature_extractor", "--database_path", "d.db"}, {"--image_path", "required"}},
      {{"feature_extractor", "--database_path"}, {"--database_path"}},
      {with({"--image_path", "j"}), {"image_path"}},
      {with({"--image_pathh", "j"}), {"--image_pathh", "--image_path?"}},
      {with({"--image", "j"}), {"--image", "no such option"}},
      {with({"stray"}), {"stray"}},
      {with({"--SiftExtraction.use_gpu", "0"}), {"SiftExtraction.use_gpu", "no such option"}},
      {with({"--Mapper.min_model_size", "3"}), {"Mapper.min_model_size", "no such option"}},
      {with({"--num_threads", "-2"}), {"--num_threads -2", "between -1 and 1024"}},
      {with({"--num_threads", "two"}), {"--num_threads two", "whole number"}},
      {with({"--SeaPointExtraction.min_num_features", "0"}),
       {"--SeaPointExtraction.min_num_features 0", "between"}},
      {with({"--ImageReader.single_camera", "2"}), {"--ImageReader.single_camera 2", "0 or 1"}},
      {with({"--ImageReader.camera_model", "BOX"}), {"--ImageReader.camera_model BOX", "PINHOLE"}},
      {with({"--ImageReader.camera_model", "PINHOLE", "--ImageReader.camera_params", "1,2,3"}),
       {"--ImageReader.camera_params 1,2,3", "4 numbers"}},
      {with({"--ImageReader.camera_params", "1,2,x,4,5,6,7,8"}), {"8 numbers"}},
      {{"automatic_reconstructor", "--image_path", "i", "--workspace_path", "w", "--matcher",
        "vocabulary"},
       {"--matcher vocabulary", "auto sequential exhaustive"}},
  };
  for (const WrongUsage& wrong : cases) {
    const CliResult result = RunSeaPoint(wrong.arguments);
    EXPECT_EQ(result.exit_code, 2) << result.Text();
    EXPECT_EQ(result.LastErrorLine().find("error: "), 0u) << result.Text();
    for (const std::string& word : wrong.words) {
      EXPECT_NE(result.LastErrorLine().find(word), std::string::npos) << word << result.Text();
    }
  }
}

class ProjectFile : public testing::Test {
 protected:
  CliResult Extract(const std::string& text, const std::vector<std::string>& more = {}) {
    WriteBytes(folder_ / "project.ini", text);
    std::vector<std::string> arguments = {"feature_extractor", "--project_path",
                                          (folder_ / "project.ini").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunSeaPoint(arguments);
  }

  TemporaryFolder folder_;
};

TEST_F(ProjectFile, GivesOptionsAndTheCommandLineWins) {
  WriteStrip(folder_ / "images", 1);
  const std::string text =
      "# a comment\nlog_level=2\ndatabase_path=" + (folder_ / "a.db").string() +
      "\nimage_path=" + (folder_ / "images").string() +
      "\nimage_list_path=\n[ImageReader]\nsingle_camera=true\n"
      "[SeaPointExtraction]\nmin_num_features=20\nmax_num_features=30\n"
      "[PartialDensification]\nmode=complete\n[Mapper]\nmin_model_size=3\n";
  CliResult result = Extract(text);
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  std::string report = ReadBytes(folder_ / "a.db.feature_extractor.run.json");
  EXPECT_NE(report.find("\"SeaPointExtraction.max_num_features\": \"30\""), std::string::npos);
  EXPECT_NE(report.find("\"ImageReader.single_camera\": \"1\""), std::string::npos);

  result = Extract(text, {"--SeaPointExtraction.max_num_features", "40"});
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  report = ReadBytes(folder_ / "a.db.feature_extractor.run.json");
  EXPECT_NE(report.find("\"SeaPointExtraction.max_num_features\": \"40\""), std::string::npos);
  EXPECT_NE(report.find("\"SeaPointExtraction.min_num_features\": \"20\""), std::string::npos);
}

TEST_F(ProjectFile, MistakesNameTheFileAndTheKey) {
  const std::string path = (folder_ / "project.ini").string();
  CliResult result =
      Extract("image_path=i\ndatabase_path=d\n[SeaPointExtraction]\nmin_features=3\n");
  EXPECT_EQ(result.exit_code, 2) << result.Text();
  EXPECT_NE(result.LastErrorLine().find(path + ": SeaPointExtraction.min_features"),
            std::string::npos)
      << result.Text();
  result = Extract("image_path=i\nimage_path=j\ndatabase_path=d\n");
  EXPECT_EQ(result.exit_code, 2) << result.Text();
  EXPECT_NE(result.LastErrorLine().find("image_path"), std::string::npos) << result.Text();
  result = Extract("image_path=i\ndatabase_path=d\nno equals sign\n");
  EXPECT_EQ(result.exit_code, 2) << result.Text();
  EXPECT_NE(result.LastErrorLine().find(path), std::string::npos) << result.Text();
  result = Extract("image_path=i\ndatabase_path=d\nnum_threads=many\n");
  EXPECT_EQ(result.exit_code, 2) << result.Text();
  result = RunSeaPoint({"feature_extractor", "--project_path", path + ".absent"});
  EXPECT_EQ(result.exit_code, 1) << result.Text();
  EXPECT_NE(result.LastErrorLine().find(path + ".absent"), std::string::npos) << result.Text();
}

}  // namespace
}  // namespace colmap_seapoint
