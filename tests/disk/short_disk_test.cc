// Another program fills the disk while the chain runs.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>

#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"
#include "tests/disk/told_disk.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kEnough = 1'000'000'000;

class ShortDisk : public testing::Test {
 protected:
  ShortDisk() : disk_(folder_.Path()) {
    WriteStrip(folder_ / "images", 4);
    disk_.SetFree(kEnough);
  }

  CliResult Reconstruct(const std::string& workspace, CliOptions options,
                        const std::vector<std::string>& more = {}) const {
    options.environment["FAKE_COLMAP_PID"] = (folder_ / "pid").string();
    options.timeout_seconds = 100;
    std::vector<std::string> arguments = {"automatic_reconstructor",
                                          "--image_path",
                                          (folder_ / "images").string(),
                                          "--workspace_path",
                                          (folder_ / workspace).string(),
                                          "--colmap_path",
                                          FAKE_COLMAP,
                                          "--map",
                                          "0",
                                          "--completeness",
                                          "0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunProgram(SEAPOINT_PROGRAM, arguments, options);
  }
  pid_t Mapper() const {
    pid_t process = 0;
    std::ifstream(folder_ / "pid") >> process;
    return process;
  }
  std::string Cloud(const std::string& workspace) const {
    return ReadBytes(folder_ / workspace / "dense" / "0" / "fused.ply");
  }

  TemporaryFolder folder_;
  ToldDisk disk_;
};

TEST_F(ShortDisk, StopsTheMapperAndGoesOnLater) {
  ASSERT_EQ(Reconstruct("whole", {}).exit_code, 0);
  fs::remove(folder_ / "pid");
  CliOptions slow;
  slow.environment["FAKE_COLMAP_SECONDS"] = "60";
  slow.kill_when = [&](double) {
    if (Mapper() > 0) disk_.SetFree(1000);
    return false;
  };
  const CliResult stopped = Reconstruct("ws", slow);
  EXPECT_EQ(stopped.exit_code, 1) << stopped.Text();
  EXPECT_FALSE(ProcessIsAlive(Mapper()));
  const std::string line = stopped.LastErrorLine();
  for (const char* word : {"error: /", "has 1 MB free", "make room on this disk", "--check_disk 0",
                           "the same command goes on from there"}) {
    EXPECT_NE(line.find(word), std::string::npos) << line;
  }
  disk_.SetFree(kEnough);
  const CliResult resumed = Reconstruct("ws", {});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.Text();
  EXPECT_TRUE(Cloud("ws") == Cloud("whole"));
}

TEST_F(ShortDisk, BeginsNothingWhereItIsTooSmall) {
  disk_.SetFree(1000);
  const CliResult refused = Reconstruct("ws", {});
  EXPECT_EQ(refused.exit_code, 1) << refused.Text();
  EXPECT_FALSE(fs::exists(folder_ / "ws" / "database.db"));
  const CliResult warned = Reconstruct("ws", {}, {"--check_disk", "0"});
  EXPECT_EQ(warned.exit_code, 0) << warned.Text();
  EXPECT_NE(warned.err.find("warning: /"), std::string::npos) << warned.err;
}

// What is done takes no more room.
TEST_F(ShortDisk, AFinishedWorkspaceIsNoShortage) {
  ASSERT_EQ(Reconstruct("ws", {}).exit_code, 0);
  const std::string cloud = Cloud("ws");
  const fs::path memory = folder_ / "ws" / "state" / "map_0_abc.memory";
  WriteBytes(memory, "tiles");
  disk_.SetFree(4'000'000);  // between the least and the most that four pictures take
  const CliResult again = Reconstruct("ws", {});
  EXPECT_EQ(again.exit_code, 0) << again.Text();
  EXPECT_TRUE(Cloud("ws") == cloud);
  EXPECT_NE(again.err.find("room is short: removed what maps are continued from"),
            std::string::npos)
      << again.err;
  EXPECT_FALSE(fs::exists(memory));
}

TEST_F(ShortDisk, AWatchWaitsForRoom) {
  disk_.SetFree(1000);
  CliOptions options;
  bool has_waited = false;
  options.kill_when = [&](double seconds) {
    if (seconds > 8 && !has_waited) {
      has_waited = true;
      disk_.SetFree(kEnough);
    }
    return false;
  };
  const CliResult result = Reconstruct("ws", options, {"--watch", "1", "--watch_idle", "1"});
  EXPECT_TRUE(has_waited);
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_NE(result.err.find("Work pauses until there is room"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("work goes on"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace colmap_seapoint
