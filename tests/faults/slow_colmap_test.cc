// A colmap that hangs, and one that prints without end.
#include "tests/faults/faults_fixture.h"

namespace colmap_seapoint {
namespace {

TEST_F(Faults, AColmapThatHangsIsStopped) {
  const std::string pid_file = Path("pid");
  CliOptions options;
  options.environment = {{"FAKE_COLMAP_SECONDS", "50"}, {"FAKE_COLMAP_PID", pid_file}};
  const CliResult result = Run(Reconstruct(), options, {"--colmap_timeout", "1"});
  ExpectFailure(result, "has not ended within 1.0 s");
  EXPECT_NE(result.LastErrorLine().find("mapper_1_thinned.log"), std::string::npos)
      << result.Text();
  EXPECT_NE(result.LastErrorLine().find("run the same command again"), std::string::npos);
  EXPECT_FALSE(ProcessIsAlive(std::stoi(ReadBytes(pid_file))));
  // It goes on where it was stopped.
  const CliResult again = Run(Reconstruct(), {}, {"--colmap_timeout", "50"});
  EXPECT_EQ(again.exit_code, 0) << again.Text();
  EXPECT_NE(again.err.find("3 pictures were there already"), std::string::npos) << again.Text();
}

TEST_F(Faults, EndlessOutputTakesNeitherMemoryNorDisk) {
  CliOptions options;
  options.environment = {{"FAKE_COLMAP_MODE", "babble"}};
  const CliResult result = Run(Reconstruct(), options);
  EXPECT_EQ(result.exit_code, 0) << result.Text().substr(0, 2000);
  EXPECT_LT(result.peak_rss_bytes, 200u << 20);
  EXPECT_LT(result.err.size(), 10000u);
  const std::string log = ReadBytes(folder_ / "workspace/report/mapper_1_thinned.log");
  EXPECT_LT(log.size(), 70u << 20);
  EXPECT_NE(log.find("[the log is full"), std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
