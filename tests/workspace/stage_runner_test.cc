#include "colmap_seapoint/workspace/stage_runner.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "colmap_seapoint/io/files/run_report_json.h"
#include "tests/cli/cli_runner.h"
#include "tests/expect_error.h"
#include "tests/pipeline/strip_survey.h"

namespace colmap_seapoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const Stage kStage = {"stage", "1", "inputs", ""};

class StageRunner : public testing::Test {
 protected:
  fs::path Path() const { return folder_ / "ws"; }
  void Open() const { const WorkspaceState state(Path()); }

  // Work that writes ws/out and gives the number of times that it was done.
  int Run(WorkspaceState* state, const Stage& stage) {
    return RunStage<int>(state, stage, [&]() -> StageOutput<int> {
      WriteBytes(Path() / "out", "whole");
      return {++num_done_, {Path() / "out"}};
    });
  }
  // In a run of its own.
  int Run(const Stage& stage = kStage) {
    WorkspaceState state(Path());
    return Run(&state, stage);
  }

  TemporaryFolder folder_;
  int num_done_ = 0;
};

TEST_F(StageRunner, DoesAStageOnce) {
  WorkspaceState state(Path());
  EXPECT_EQ(Run(&state, kStage), 1);
  EXPECT_EQ(Run(&state, kStage), 1);
  EXPECT_EQ(num_done_, 1);
}

TEST_F(StageRunner, ALaterRunTakesTheResult) {
  EXPECT_EQ(Run(), 1);
  EXPECT_EQ(Run(), 1);
  EXPECT_EQ(num_done_, 1);
}

TEST_F(StageRunner, DoesItAgainWhenVersionOrInputsChange) {
  EXPECT_EQ(Run(), 1);
  Stage changed = kStage;
  changed.version = "2";
  EXPECT_EQ(Run(changed), 2);
  EXPECT_EQ(Run(changed), 2);
  changed.inputs = "others";
  EXPECT_EQ(Run(changed), 3);
  // One record a stage: the way back is new work.
  EXPECT_EQ(Run(), 4);
}

TEST_F(StageRunner, WhatIsSaidDecidesNothing) {
  EXPECT_EQ(Run(), 1);
  Stage talking = kStage;
  talking.done = "The stage was done already";
  const std::string log = LogOf([&] { EXPECT_EQ(Run(talking), 1); });
  EXPECT_NE(log.find(talking.done), std::string::npos) << log;
  EXPECT_EQ(LogOf([&] { EXPECT_EQ(Run(), 1); }), "");
}

TEST_F(StageRunner, StagesDoNotKnowEachOther) {
  Stage other = kStage;
  other.name = "other";
  EXPECT_EQ(Run(), 1);
  EXPECT_EQ(Run(other), 2);
  WorkspaceState state(Path());
  state.Forget(other.name);
  EXPECT_EQ(Run(&state, kStage), 1);
  EXPECT_EQ(Run(&state, other), 3);
}

TEST_F(StageRunner, DoesItAgainWhenAnOutputIsGone) {
  EXPECT_EQ(Run(), 1);
  fs::remove(Path() / "out");
  EXPECT_EQ(Run(), 2);
  EXPECT_EQ(ReadBytes(Path() / "out"), "whole");
}

TEST_F(StageRunner, EveryOutputCounts) {
  WorkspaceState state(Path());
  const std::vector<fs::path> outputs = {Path() / "a", Path() / "folder", Path() / "folder/b"};
  for (const fs::path& gone : outputs) {
    WriteBytes(Path() / "a", "");
    WriteBytes(Path() / "folder/b", "");
    FinishStage(kStage, 7, outputs, &state);
    EXPECT_EQ(ResultIfDone<int>(state, kStage), 7);
    fs::remove_all(gone);
    EXPECT_EQ(ResultIfDone<int>(state, kStage), std::nullopt) << gone;
  }
}

TEST_F(StageRunner, AMovedWorkspaceIsStillDone) {
  EXPECT_EQ(Run(), 1);
  const std::string record = ReadBytes(Path() / "state/stage.json");
  EXPECT_EQ(record.find(folder_.Path().string()), std::string::npos) << record;
  fs::rename(Path(), folder_ / "elsewhere");
  WorkspaceState state(folder_ / "elsewhere");
  EXPECT_EQ(Run(&state, kStage), 1);
  fs::remove(folder_ / "elsewhere/out");
  EXPECT_EQ(Run(&state, kStage), 2);
}

TEST_F(StageRunner, ADamagedRecordIsNone) {
  EXPECT_EQ(Run(), 1);
  const std::string whole = ReadBytes(Path() / "state/stage.json");
  const std::string damaged[] = {"",   "{",        "[]",       "null",
                                 "{}", "\"text\"", "\xff\xfe", whole.substr(0, whole.size() / 2)};
  int expected = 1;
  for (const std::string& bytes : damaged) {
    WriteBytes(Path() / "state/stage.json", bytes);
    EXPECT_EQ(Run(), ++expected) << bytes;
    EXPECT_EQ(Run(), expected) << "the record was not mended";
  }
}

TEST_F(StageRunner, ARecordOfAnotherTypeIsNone) {
  EXPECT_EQ(Run(), 1);
  const Json whole = Json::parse(ReadBytes(Path() / "state/stage.json"));
  const auto expect_again = [&](const std::string& key, const Json& value) {
    Json changed = whole;
    changed[key] = value;
    WriteBytes(Path() / "state/stage.json", changed.dump());
    const int before = num_done_;
    EXPECT_EQ(Run(), before + 1) << changed.dump();
  };
  expect_again("fingerprint", 3);
  expect_again("fingerprint", nullptr);
  expect_again("outputs", {1, 2});
  expect_again("outputs", {"out", nullptr});
  expect_again("result", "seven");
  expect_again("result", {{"number", 7}});
}

// Earlier versions kept the report itself, with the fingerprint beside its other keys.
TEST_F(StageRunner, ARecordOfAnOlderVersionIsNone) {
  WorkspaceState state(Path());
  RunReport report;
  report.version = "0.1.0";
  Json old = report;
  old["fingerprint"] = StageFingerprint(kStage);
  WriteBytes(Path() / "out", "");
  state.Write(kStage.name, old);
  ASSERT_TRUE(ReadIfDone(state, kStage).has_value());
  EXPECT_EQ(ResultIfDone<RunReport>(state, kStage).has_value(), false);
  EXPECT_EQ(Run(&state, kStage), 1);
  EXPECT_EQ(Run(&state, kStage), 1);
}

TEST_F(StageRunner, IsForgottenBeforeTheWork) {
  WorkspaceState state(Path());
  EXPECT_EQ(Run(&state, kStage), 1);
  Stage changed = kStage;
  changed.inputs = "others";
  bool was_known = true;
  RunStage<int>(&state, changed, [&]() -> StageOutput<int> {
    was_known = state.Read(kStage.name).has_value() || fs::exists(Path() / "state/stage.json");
    return {0, {}};
  });
  EXPECT_FALSE(was_known);
}

TEST_F(StageRunner, WorkThatThrowsLeavesNoRecord) {
  WorkspaceState state(Path());
  EXPECT_EQ(Run(&state, kStage), 1);
  Stage changed = kStage;
  changed.inputs = "others";
  const auto work = []() -> StageOutput<int> { throw std::runtime_error("no space"); };
  EXPECT_THROW(RunStage<int>(&state, changed, work), std::runtime_error);
  EXPECT_FALSE(state.Read(kStage.name).has_value());
  // Half an output may be there: what it was before is not taken for it.
  EXPECT_EQ(Run(&state, kStage), 2);
}

TEST_F(StageRunner, KeepsResultsOfAnyKind) {
  using Names = std::vector<std::string>;
  WorkspaceState state(Path());
  const Names names = {"a", "", "caf\xc3\xa9"};
  const auto give = [&]() -> StageOutput<Names> { return {names, {}}; };
  EXPECT_EQ(RunStage<Names>(&state, kStage, give), names);
  EXPECT_EQ(ResultIfDone<Names>(state, kStage), names);
  // File names can hold any bytes; a record is UTF-8.
  FinishStage(kStage, Names{"b\xff.png"}, {}, &state);
  EXPECT_EQ(ResultIfDone<Names>(state, kStage), (Names{"b\xef\xbf\xbd.png"}));
}

TEST_F(StageRunner, FingerprintsTellVersionsAndInputsApart) {
  const std::string fingerprint = StageFingerprint(kStage);
  EXPECT_EQ(fingerprint.size(), 21u);
  const Stage same = {"other name", "1", "inputs", "said"};
  EXPECT_EQ(StageFingerprint(same), fingerprint);
  for (const Stage& other : {Stage{"stage", "11", "nputs", ""}, Stage{"stage", "2", "inputs", ""},
                             Stage{"stage", "1", "", ""}, Stage{"stage", "", "1inputs", ""}}) {
    EXPECT_NE(StageFingerprint(other), fingerprint) << other.version << other.inputs;
  }
}

TEST_F(StageRunner, AWorkspaceThatIsAFileIsSaid) {
  WriteBytes(folder_ / "file", "x");
  EXPECT_ERROR(WorkspaceState(folder_ / "file"), "file");
  EXPECT_EQ(ReadBytes(folder_ / "file"), "x");
}

TEST_F(StageRunner, ForgettingWhatIsNotKnownIsNothing) {
  WorkspaceState state(Path());
  EXPECT_NO_THROW(state.Forget("never"));
  EXPECT_FALSE(state.Read("never").has_value());
}

// A process that holds the lock of a workspace.
class Holder {
 public:
  // `seconds`: then it ends by itself.
  Holder(const fs::path& workspace, double seconds) {
    std::array<int, 2> ready = {-1, -1};
    if (pipe(ready.data()) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
      const WorkspaceState state(workspace);
      (void)!write(ready[1], "x", 1);
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
      _exit(0);  // as a killed program: no destructor runs
    }
    char letter = 0;
    (void)!read(ready[0], &letter, 1);
    close(ready[0]);
    close(ready[1]);
  }
  ~Holder() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;

 private:
  pid_t process_ = 0;
};

TEST_F(StageRunner, OneRunAtATimeInAWorkspace) {
  {
    const Holder other(Path(), 60);
    EXPECT_ERROR(Open(), "another run is at work");
    EXPECT_NO_THROW(WorkspaceState(folder_ / "another"));
  }
  EXPECT_NO_THROW(Open());
}

TEST_F(StageRunner, ARunThatIsAboutToEndIsWaitedFor) {
  const Holder other(Path(), 0.3);
  EXPECT_NO_THROW(Open());
}

// A run that the system killed could not say so itself.
TEST_F(StageRunner, TellsOfARunThatDidNotComeToItsEnd) {
  EXPECT_EQ(LogOf([&] { Open(); }), "");
  { const Holder killed(Path(), 60); }
  const std::string log = LogOf([&] { Open(); });
  EXPECT_NE(log.find("the run before did not come to its end"), std::string::npos) << log;
  EXPECT_EQ(LogOf([&] { Open(); }), "");
}

TEST_F(StageRunner, TheLockEndsWithItsObject) {
  for (int i = 0; i < 2; ++i) {
    WorkspaceState state(Path());
    EXPECT_EQ(Run(&state, kStage), 1);
  }
}

class StaleStages : public StageRunner {
 protected:
  // A record and a folder.
  void Finish(const std::string& prefix, int k, WorkspaceState* state) const {
    const std::string number = std::to_string(k);
    OutputFolder folder(Path() / prefix / number, "--path");
    folder.Claim({"file"});
    WriteBytes(Path() / prefix / number / "file", "x");
    FinishStage({prefix + number, "1", "", ""}, k, {Path() / prefix / number}, state);
  }
};

TEST_F(StaleStages, GoFromTheFirstOn) {
  WorkspaceState state(Path());
  for (int k = 0; k < 4; ++k) Finish("dense_", k, &state);
  Finish("scale_", 2, &state);
  RemoveStaleStages("dense_", 2, Path() / "dense_", &state);
  for (int k = 0; k < 4; ++k) {
    const std::string number = std::to_string(k);
    EXPECT_EQ(state.Read("dense_" + number).has_value(), k < 2) << k;
    EXPECT_EQ(fs::exists(Path() / "dense_" / number), k < 2) << k;
  }
  EXPECT_TRUE(state.Read("scale_2").has_value());
  EXPECT_TRUE(fs::exists(Path() / "scale_/2/file"));
}

TEST_F(StaleStages, NoneIsNothing) {
  WorkspaceState state(Path());
  Finish("dense_", 0, &state);
  RemoveStaleStages("dense_", 1, Path() / "dense_", &state);
  RemoveStaleStages("never_", 0, Path() / "never_", &state);
  EXPECT_TRUE(fs::exists(Path() / "dense_/0/file"));
}

// Between two models that were scaled, one may have failed: it left no record.
TEST_F(StaleStages, GoBehindAGapToo) {
  WorkspaceState state(Path());
  for (const int k : {0, 1, 3}) Finish("scale_", k, &state);
  RemoveStaleStages("scale_", 1, Path() / "scale_", &state);
  EXPECT_TRUE(state.Read("scale_0").has_value());
  EXPECT_FALSE(state.Read("scale_1").has_value());
  EXPECT_FALSE(state.Read("scale_3").has_value());
  EXPECT_FALSE(fs::exists(Path() / "scale_/3"));
}

}  // namespace
}  // namespace colmap_seapoint
