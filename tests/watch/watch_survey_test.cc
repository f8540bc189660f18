// automatic_reconstructor --watch as a user runs it: pictures come, half of one, one that shows
// nothing of the others; what it says meanwhile, and that the end is that of a run of all of them.
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>

#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class WatchSurvey : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "all", 9);
    fs::create_directories(folder_ / "images");
  }

  void Come(int picture) const {
    const std::string name = "img" + std::to_string(picture) + ".png";
    fs::copy_file(folder_ / "all" / name, folder_ / "images" / name);
  }

  CliResult Reconstruct(const std::string& images, const std::string& workspace,
                        const std::vector<std::string>& more, CliOptions options = {}) const {
    std::vector<std::string> arguments = {"automatic_reconstructor",
                                          "--image_path",
                                          (folder_ / images).string(),
                                          "--workspace_path",
                                          (folder_ / workspace).string(),
                                          "--colmap_path",
                                          FAKE_COLMAP};
    arguments.insert(arguments.end(), more.begin(), more.end());
    options.timeout_seconds = 280;  // rounds take long on a busy machine
    options.environment["FAKE_COLMAP_MODE"] = "continues";
    options.environment["XDG_CACHE_HOME"] = (folder_ / "cache").string();
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }

  // Pictures that the last round has put into the map; 0 before the first one.
  int NumInMap() const {
    const fs::path report = folder_ / "watched" / "watch" / "report" / "run.json";
    if (!fs::exists(report)) return 0;
    return nlohmann::json::parse(ReadBytes(report)).value("images_used", 0);
  }

  std::string Summary(const std::string& workspace) const {
    return ReadBytes(folder_ / workspace / "report" / "summary.txt");
  }

  TemporaryFolder folder_;
};

bool Says(const CliResult& result, const std::string& what) {
  return result.err.find(what) != std::string::npos;
}

TEST_F(WatchSurvey, EndsAsARunOfAllOfThem) {
  ASSERT_EQ(Reconstruct("all", "batch", {}).exit_code, 0);
  for (const int picture : {1, 2, 3, 4}) Come(picture);
  const std::string last = ReadBytes(folder_ / "all" / "img9.png");
  CliOptions options;
  options.kill_signal = SIGINT;
  size_t step = 0;
  options.kill_when = [&](double) {
    constexpr int kInMap[] = {4, 5, 6, 9};  // before each step
    if (NumInMap() < kInMap[step]) return false;
    if (step == 0) {
      WriteBytes(folder_ / "images" / "img9.png", last.substr(0, last.size() / 2));
      Come(5);
    }
    if (step == 1) Come(8);
    if (step == 2) {
      WriteBytes(folder_ / "images" / "img9.png", last);
      Come(6);
      Come(7);
    }
    return ++step == 4;
  };
  const CliResult watched = Reconstruct("images", "watched", {"--watch", "1"}, options);
  ASSERT_EQ(watched.exit_code, 0) << watched.Text();
  EXPECT_TRUE(Says(watched, "Round 1: ")) << watched.err;
  EXPECT_TRUE(Says(watched, "img5.png")) << watched.err;
  EXPECT_TRUE(Says(watched, "warning: img8.png overlaps the last pictures by 3")) << watched.err;
  EXPECT_TRUE(Says(watched, "6 of 6 pictures in the map")) << watched.err;
  EXPECT_TRUE(Says(watched, "; in the map after ")) << watched.err;
  EXPECT_FALSE(Says(watched, "truncated")) << watched.err;
  EXPECT_TRUE(fs::exists(folder_ / "watched" / "watch" / "map" / "0" / "orthomosaic.jpg"));
  for (const char* file : {"sparse/0/images.bin", "dense/0/fused.ply", "map/0/orthomosaic.tif"}) {
    EXPECT_EQ(ReadBytes(folder_ / "watched" / file), ReadBytes(folder_ / "batch" / file)) << file;
  }
  // And there is nothing left to do.
  const CliResult again = Reconstruct("images", "watched", {});
  EXPECT_TRUE(Says(again, "The models in ")) << again.err;
  EXPECT_TRUE(Says(again, "The cloud in ")) << again.err;
}

TEST_F(WatchSurvey, GoesOnAfterWhatFailsAndEndsWhenIdle) {
  for (const int picture : {1, 2}) Come(picture);
  CliOptions options;
  int step = 0;
  options.kill_when = [&](double now) {
    if (now < 1.0 * (step + 1)) return false;
    ++step;
    if (step == 1) WriteBytes(folder_ / "images" / "rubbish.jpg", "no picture");
    if (step == 2) Come(3);
    if (step == 3) fs::rename(folder_ / "images", folder_ / "pulled");
    if (step == 6) fs::rename(folder_ / "pulled", folder_ / "images");
    if (step == 7) Come(4);
    return false;
  };
  const CliResult watched =
      Reconstruct("images", "watched", {"--watch", "1", "--watch_idle", "4"}, options);
  EXPECT_EQ(watched.exit_code, 3) << watched.Text();
  EXPECT_TRUE(Says(watched, "tried again until it is mended")) << watched.err;
  EXPECT_TRUE(Says(watched, "is there again")) << watched.err;
  EXPECT_TRUE(Says(watched, "rubbish.jpg")) << watched.err;
  EXPECT_NE(Summary("watched").find("4 of 5 pictures used"), std::string::npos)
      << Summary("watched");
}

TEST_F(WatchSurvey, KilledItGoesOn) {
  for (const int picture : {1, 2, 3, 4}) Come(picture);
  CliOptions options;
  options.kill_when = [&](double now) { return now > 1; };
  EXPECT_EQ(Reconstruct("images", "watched", {"--watch", "1"}, options).signal_number, SIGKILL);
  Come(5);
  const CliResult watched = Reconstruct("images", "watched", {"--watch", "1", "--watch_idle", "1"});
  EXPECT_EQ(watched.exit_code, 0) << watched.Text();
  EXPECT_NE(Summary("watched").find("5 of 5 pictures used"), std::string::npos);
}

TEST_F(WatchSurvey, WantsAFolder) {
  WriteBytes(folder_ / "dive.mp4", "a film");
  const CliResult result = Reconstruct("dive.mp4", "watched", {"--watch", "1"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.LastErrorLine().find("--watch"), std::string::npos) << result.Text();
  const CliResult inside = Reconstruct("images", "images/workspace", {"--watch", "1"});
  EXPECT_EQ(inside.exit_code, 2);
  EXPECT_NE(inside.LastErrorLine().find("is watched"), std::string::npos) << inside.Text();
}

}  // namespace
}  // namespace colmap_seapoint
