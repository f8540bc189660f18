// kill -9 at any moment, changed options and changed pictures: the same command again ends with
// what an uninterrupted run gives.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "colmap_seapoint/io/image/image_file.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class Resume : public testing::Test {
 protected:
  void SetUp() override { WriteStrip(folder_ / "images", 6); }

  CliResult Reconstruct(const std::string& workspace, const std::vector<std::string>& more = {},
                        const CliOptions& options = {}) const {
    std::vector<std::string> arguments = {"automatic_reconstructor",
                                          "--image_path",
                                          (folder_ / "images").string(),
                                          "--workspace_path",
                                          (folder_ / workspace).string(),
                                          "--colmap_path",
                                          FAKE_COLMAP};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }

  // Models, clouds and maps, and what the report says of the pictures.
  std::map<std::string, std::string> Result(const std::string& workspace) const {
    std::map<std::string, std::string> result;
    for (const char* part : {"sparse", "dense", "map"}) {
      for (const auto& [name, bytes] : ReadTree(folder_ / workspace / part)) {
        const std::string end = fs::path(name).extension().string();
        for (const char* kept : {".bin", ".ply", ".vis", ".tif", ".png", ".jpg"}) {
          if (end == kept) result[part + ("/" + name)] = bytes;
        }
      }
    }
    const auto report =
        nlohmann::json::parse(ReadBytes(folder_ / workspace / "report" / "run.json"));
    for (const char* key : {"images_in", "images_used", "left_out", "pairs", "points", "inputs"}) {
      result[key] = report[key].dump();
    }
    return result;
  }

  void ExpectSameResult(const std::string& workspace1, const std::string& workspace2) const {
    const auto result1 = Result(workspace1), result2 = Result(workspace2);
    ASSERT_EQ(result1.size(), result2.size());
    for (const auto& [name, bytes] : result1) {
      EXPECT_TRUE(result2.count(name) > 0 && result2.at(name) == bytes) << name;
    }
  }

  TemporaryFolder folder_;
};

TEST_F(Resume, KilledAtManyMoments) {
  CliOptions slow_mapper;
  slow_mapper.environment["FAKE_COLMAP_SECONDS"] = "0.2";
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(Reconstruct("whole", {}, slow_mapper).exit_code, 0);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  constexpr int kNumKills = 10;
  int num_killed = 0;
  for (int i = 1; i <= kNumKills; ++i) {
    CliOptions options = slow_mapper;
    const double moment = seconds * i / (kNumKills + 1);
    options.kill_when = [&](double now) { return now > moment; };
    num_killed += Reconstruct("killed once", {}, options).signal_number == SIGKILL;
    const CliResult restarted = Reconstruct("killed once", {}, slow_mapper);
    ASSERT_EQ(restarted.exit_code, 0) << "killed after " << moment << " s\n" << restarted.Text();
    ExpectSameResult("whole", "killed once");
    fs::remove_all(folder_ / "killed once");
  }
  EXPECT_GE(num_killed, kNumKills / 2);
}

TEST_F(Resume, KilledAgainAndAgain) {
  ASSERT_EQ(Reconstruct("whole").exit_code, 0);
  CliOptions options;
  CliResult result;
  for (double seconds = 0.05; seconds < 20; seconds *= 1.3) {
    options.kill_when = [&](double now) { return now > seconds; };
    result = Reconstruct("killed", {}, options);
    if (result.signal_number == 0) break;
  }
  ASSERT_EQ(result.exit_code, 0) << result.Text();
  ExpectSameResult("whole", "killed");
}

// 0 while the file is not there.
pid_t ProcessIdIn(const fs::path& path) {
  pid_t process = 0;
  std::ifstream(path) >> process;
  return process;
}

TEST_F(Resume, TheMapperDiesWithUs) {
  CliOptions options;
  options.environment["FAKE_COLMAP_SECONDS"] = "100";
  options.environment["FAKE_COLMAP_PID"] = (folder_ / "pid").string();
  pid_t mapper = 0;
  options.kill_when = [&](double) {
    mapper = ProcessIdIn(folder_ / "pid");
    return mapper > 0 && ProcessIsAlive(mapper);
  };
  EXPECT_EQ(Reconstruct("workspace", {}, options).signal_number, SIGKILL);
  ASSERT_GT(mapper, 0);
  for (int i = 0; i < 200 && ProcessIsAlive(mapper); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_FALSE(ProcessIsAlive(mapper));
}

TEST_F(Resume, TwoRunsInOneWorkspace) {
  CliOptions options;
  options.environment["FAKE_COLMAP_SECONDS"] = "100";
  options.environment["FAKE_COLMAP_PID"] = (folder_ / "pid").string();
  CliResult second;
  options.kill_when = [&](double) {
    if (ProcessIdIn(folder_ / "pid") == 0) return false;
    second = Reconstruct("workspace");
    return true;
  };
  EXPECT_EQ(Reconstruct("workspace", {}, options).signal_number, SIGKILL);
  EXPECT_EQ(second.exit_code, 1) << second.Text();
  EXPECT_NE(second.LastErrorLine().find("another run"), std::string::npos) << second.Text();
  EXPECT_EQ(Reconstruct("workspace").exit_code, 0);
}

TEST_F(Resume, NothingIsDoneTwice) {
  ASSERT_EQ(Reconstruct("workspace").exit_code, 0);
  const auto written = fs::last_write_time(folder_ / "workspace/dense/0/fused.ply");
  CliOptions options;
  options.environment["FAKE_COLMAP_MODE"] = "crash";  // it is not even asked
  const CliResult result = Reconstruct("workspace", {}, options);
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(fs::last_write_time(folder_ / "workspace/dense/0/fused.ply"), written);
}

TEST_F(Resume, AChangedOptionRedoesItsStageAndAllAfterIt) {
  const std::vector<std::vector<std::string>> changes = {
      {"--SeaPointExtraction.min_num_features", "700", "--SeaPointExtraction.max_num_features",
       "900"},
      {"--matcher", "sequential", "--SequentialMatching.overlap", "1"},
      {"--SeaPointMatching.max_distance", "60"},
      {"--ImageReader.camera_model", "SIMPLE_RADIAL"},
      {"--PartialDensification.step", "4"},
  };
  ASSERT_EQ(Reconstruct("changed").exit_code, 0);
  for (size_t i = 0; i < changes.size(); ++i) {
    const CliResult changed = Reconstruct("changed", changes[i]);
    ASSERT_EQ(changed.exit_code, 0) << changed.Text();
    const std::string fresh = "fresh" + std::to_string(i);
    ASSERT_EQ(Reconstruct(fresh, changes[i]).exit_code, 0);
    ExpectSameResult(fresh, "changed");
  }
}

TEST_F(Resume, ChangedPicturesGiveWhatAFreshRunGives) {
  ASSERT_EQ(Reconstruct("changed").exit_code, 0);
  WriteImage(folder_ / "images" / "img7.png", StripPicture(7));
  fs::remove(folder_ / "images" / "img1.png");
  ASSERT_EQ(Reconstruct("changed").exit_code, 0);
  ASSERT_EQ(Reconstruct("fresh").exit_code, 0);
  ExpectSameResult("fresh", "changed");
  // The same name, another picture: its matches go with it.
  ColorImage brighter = StripPicture(5);
  for (uint8_t& value : brighter.data) value = static_cast<uint8_t>(value / 2 + 60);
  WriteImage(folder_ / "images" / "img5.png", brighter);
  ASSERT_EQ(Reconstruct("changed").exit_code, 0);
  ASSERT_EQ(Reconstruct("fresh again").exit_code, 0);
  ExpectSameResult("fresh again", "changed");
}

}  // namespace
}  // namespace colmap_seapoint
