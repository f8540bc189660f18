// --pause_on_battery as a user meets it: the mapper is stopped, goes on, and never outlives us.
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;

class PauseOnBattery : public testing::Test {
 protected:
  void SetUp() override {
    WriteStrip(folder_ / "images", 4);
    Battery("Charging");
  }

  void Battery(const std::string& status) const {
    const fs::path supply = folder_ / "power" / "BAT0";
    fs::create_directories(supply);
    WriteBytes(supply / "type", "Battery\n");
    WriteBytes(supply / "capacity", "15\n");
    WriteBytes(supply / "status", status + "\n");
  }

  // 0 while it does not run.
  pid_t Mapper() const {
    pid_t process = 0;
    std::ifstream(folder_ / "pid") >> process;
    return process > 0 && ProcessIsAlive(process) ? process : 0;
  }

  bool MapperIsStopped() const {
    const pid_t process = Mapper();
    if (process == 0) return false;
    const std::string stat = ReadBytes("/proc/" + std::to_string(process) + "/stat");
    return stat.find(") T ") != std::string::npos;
  }

  CliResult Reconstruct(CliOptions options) const {
    options.environment["SEAPOINT_POWER_SUPPLY"] = (folder_ / "power").string();
    options.environment["FAKE_COLMAP_SECONDS"] = "12";
    options.environment["FAKE_COLMAP_PID"] = (folder_ / "pid").string();
    options.timeout_seconds = 100;
    return RunProgram(
        SEAPOINT_PROGRAM,
        {"automatic_reconstructor", "--image_path", (folder_ / "images").string(),
         "--workspace_path", (folder_ / "workspace").string(), "--colmap_path", FAKE_COLMAP,
         "--pause_on_battery", "20", "--map", "0", "--completeness", "0"},
        options);
  }

  TemporaryFolder folder_;
};

TEST_F(PauseOnBattery, TheMapperWaitsAndGoesOn) {
  CliOptions options;
  bool is_low = false, was_stopped = false;
  options.kill_when = [&](double) {
    if (!is_low && Mapper() > 0) {
      Battery("Discharging");
      is_low = true;
    }
    if (!was_stopped && MapperIsStopped()) {
      was_stopped = true;
      Battery("Charging");
    }
    return false;
  };
  const CliResult result = Reconstruct(options);
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_TRUE(was_stopped);
  EXPECT_NE(result.err.find("The battery holds 15 %: work pauses"), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("work goes on"), std::string::npos) << result.err;
}

TEST_F(PauseOnBattery, AStoppedMapperDiesWithUs) {
  CliOptions options;
  bool is_low = false;
  pid_t mapper = 0;
  options.kill_when = [&](double) {
    if (!is_low && Mapper() > 0) {
      Battery("Discharging");
      is_low = true;
    }
    if (MapperIsStopped()) mapper = Mapper();
    return mapper > 0;
  };
  EXPECT_EQ(Reconstruct(options).signal_number, SIGKILL);
  ASSERT_GT(mapper, 0);
  for (int i = 0; i < 500 && ProcessIsAlive(mapper); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_FALSE(ProcessIsAlive(mapper));
}

}  // namespace
}  // namespace colmap_seapoint
