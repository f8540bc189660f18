// A disk that takes no more, and calls that are done in part.
#include "tests/cli/database_tables.h"
#include "tests/faults/fault_injector.h"
#include "tests/faults/faults_fixture.h"

namespace colmap_seapoint {
namespace {

class WriteErrors : public Faults {
 protected:
  void SetUp() override {
    if (!CanInjectFaults()) GTEST_SKIP() << "this system answers no calls for others";
    Faults::SetUp();
  }

  CliOptions FaultAt(SystemCall call) const {
    CliOptions options;
    options.fault.emplace();
    options.fault->calls = {call};
    options.fault->path_begin = folder_.Path().string();
    options.fault->error_number = ENOSPC;
    return options;
  }
};

// Half a read or write is no failure: the rest follows.
TEST_F(WriteErrors, EveryCallIsShort) {
  ASSERT_EQ(Run(Densify("whole")).exit_code, 0);
  ASSERT_EQ(Run(Extract("whole.db")).exit_code, 0);
  for (const SystemCall call : {SystemCall::kRead, SystemCall::kWrite}) {
    CliOptions options = FaultAt(call);
    options.fault->action = FaultAction::kShorten;
    const CliResult densified = Run(Densify(), options);
    EXPECT_GT(densified.faults.num_hits, 10);
    EXPECT_EQ(densified.exit_code, 0) << densified.Text();
    for (const char* name : {"/fused.ply", "/fused.ply.vis"}) {
      EXPECT_TRUE(ReadBytes(Path("dense") + name) == ReadBytes(Path("whole") + name)) << name;
    }
    const CliResult extracted = Run(Extract(), options);
    EXPECT_EQ(extracted.exit_code, 0) << extracted.Text();
    EXPECT_TRUE(ReadTables(Path("d.db")) == ReadTables(Path("whole.db")));
    std::filesystem::remove_all(Path("dense"));
    std::filesystem::remove(Path("d.db"));
  }
}

// A run that succeeds leaves all in the one file: who copies it must not need the -wal beside it.
TEST_F(WriteErrors, ADatabaseIsOneFileOrTheRunFails) {
  ASSERT_EQ(Run(Extract()).exit_code, 0);
  const std::string extracted = ReadBytes(Path("d.db"));
  CliOptions options = FaultAt(SystemCall::kWrite);
  options.fault->path_end = "/d.db";
  int num_failed = 0, num_calls = 1;
  for (int call = 0; call < num_calls; ++call) {
    WriteBytes(Path("d.db"), extracted);
    options.fault->num_calls_before = call;
    options.fault->max_hits = 1;
    const CliResult result = Run(Match(), options);
    num_calls = std::max(num_calls, result.faults.num_calls);
    EXPECT_FALSE(std::filesystem::exists(Path("d.db-wal")) && result.exit_code == 0)
        << result.Text();
    if (result.exit_code == 0) continue;
    ++num_failed;
    ExpectFailure(result, "the disk");
    EXPECT_EQ(Run(Match()).exit_code, 0);
    EXPECT_FALSE(std::filesystem::exists(Path("d.db-wal")));
  }
  EXPECT_GT(num_failed, 2);
}

}  // namespace
}  // namespace colmap_seapoint
