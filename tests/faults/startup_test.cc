// How the program is started: descriptors that are closed, signals, a stdout that takes nothing.
#include <signal.h>

#include "tests/faults/faults_fixture.h"

namespace colmap_seapoint {
namespace {

TEST_F(Faults, ClosedDescriptorsGetIntoNoFile) {
  ASSERT_EQ(Run(Densify("open")).exit_code, 0);
  for (const std::vector<int>& closed :
       {std::vector<int>{0}, std::vector<int>{2}, std::vector<int>{0, 1, 2}}) {
    CliOptions options;
    options.closed_descriptors = closed;
    const CliResult result = Run(Densify("closed"), options, {"--log_level", "3"});
    EXPECT_EQ(result.exit_code, 0) << result.Text();
    EXPECT_EQ(ReadBytes(folder_ / "closed/fused.ply"), ReadBytes(folder_ / "open/fused.ply"));
    EXPECT_EQ(ReadBytes(folder_ / "closed/fused.ply.vis"),
              ReadBytes(folder_ / "open/fused.ply.vis"));
  }
}

TEST_F(Faults, ResultsThatNobodyGets) {
  CliOptions full;
  full.out_path = "/dev/full";
  ExpectFailure(Run({"help"}, full), "No space left on device");
  ExpectFailure(Run({"version"}, full), "No space left on device");
  ExpectFailure(Run({"partial_densifier", "-h"}, full), "No space left on device");
  CliOptions closed;
  closed.closed_descriptors = {1};
  ExpectFailure(Run({"version"}, closed), "Bad file descriptor");
  // A command that has nothing to say there loses nothing.
  EXPECT_EQ(Run(Extract(), full).exit_code, 0);
}

// Who stops reading the log (`2>&1 | head -1`) does not end hours of work.
TEST_F(Faults, ALogThatNobodyReads) {
  std::string command = "(sleep 0.2; " SEAPOINT_PROGRAM;
  for (const std::string& argument : Densify()) command += " '" + argument + "'";
  command += " 2>&1; echo $? > " + Path("code") + ") | true";
  EXPECT_EQ(RunProgram("/bin/sh", {"-c", command}).exit_code, 0);
  EXPECT_EQ(ReadBytes(folder_ / "code"), "0\n");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "dense/fused.ply"));
}

TEST_F(Faults, AFileThatMayNotGrow) {
  CliOptions options;
  options.max_file_bytes = 20000;
  ExpectFailure(Run(Densify(), options), "File too large");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "dense/fused.ply"));
  ExpectFailure(Run(Extract(), options), "d.db");
}

// The mapper takes seconds, so that the signal comes while it runs.
TEST_F(Faults, SignalsSayOneLineAndEndTheChildToo) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    const std::string name = "workspace" + std::to_string(number);
    const std::string pid_file = Path(name + ".pid");
    CliOptions options;
    options.environment = {{"FAKE_COLMAP_SECONDS", "30"}, {"FAKE_COLMAP_PID", pid_file}};
    options.kill_when = [&](double) { return !ReadBytes(pid_file).empty(); };
    options.kill_signal = number;
    const CliResult result = Run(Reconstruct(name), options);
    EXPECT_EQ(result.signal_number, number) << result.Text();
    EXPECT_EQ(result.LastErrorLine(), "error: interrupted; run the same command again to continue");
    const pid_t mapper = std::stoi(ReadBytes(pid_file));
    for (int i = 0; i < 200 && ProcessIsAlive(mapper); ++i) usleep(10000);
    EXPECT_FALSE(ProcessIsAlive(mapper));
    EXPECT_EQ(Run(Reconstruct(name)).exit_code, 0);
  }
}

}  // namespace
}  // namespace colmap_seapoint
