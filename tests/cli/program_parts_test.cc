// The parts of the program that a command line alone does not reach: child processes, run reports.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/io/files/run_report.h"
#include "colmap_seapoint/io/files/run_report_json.h"
#include "colmap_seapoint/io/files/subprocess.h"
#include "tests/cli/cli_runner.h"

namespace colmap_seapoint {
namespace {

constexpr char kShell[] = "/bin/sh";

std::vector<std::string> Lines(const std::filesystem::path& program,
                               const std::vector<std::string>& arguments,
                               SubprocessResult* result = nullptr) {
  std::vector<std::string> lines;
  const auto end = RunSubprocess(program, arguments, {},
                                 [&](const std::string& line) { lines.push_back(line); });
  if (result != nullptr) *result = end;
  return lines;
}

TEST(Subprocess, PassesArgumentsUntouched) {
  const std::vector<std::string> odd = {"a b", "$HOME", "'", "\"", "*", "", "; rm x", "\xc3\xa9"};
  std::vector<std::string> arguments = {"-c", "for a in \"$@\"; do printf '%s\\n' \"$a\"; done",
                                        "-"};
  arguments.insert(arguments.end(), odd.begin(), odd.end());
  EXPECT_EQ(Lines(kShell, arguments), odd);
}

TEST(Subprocess, ReportsTheEnd) {
  SubprocessResult result;
  Lines(kShell, {"-c", "exit 7"}, &result);
  EXPECT_EQ(result.exit_code, 7);
  EXPECT_FALSE(result.Succeeded());
  EXPECT_EQ(result.Text(), "exit code 7");
  Lines(kShell, {"-c", "kill -KILL $$"}, &result);
  EXPECT_EQ(result.signal_number, 9);
  EXPECT_NE(result.Text().find("signal 9"), std::string::npos);
  Lines(kShell, {"-c", "true"}, &result);
  EXPECT_TRUE(result.Succeeded());
}

TEST(Subprocess, GivesAnEmptyInputAndNoDisplay) {
  EXPECT_EQ(Lines(kShell, {"-c", "cat; echo end"}), (std::vector<std::string>{"end"}));
  EXPECT_EQ(Lines(kShell, {"-c", "echo $QT_QPA_PLATFORM"}),
            (std::vector<std::string>{"offscreen"}));
}

TEST(Subprocess, LogsBothStreams) {
  const TemporaryFolder folder;
  std::string lines;
  RunSubprocess(kShell, {"-c", "echo out; echo err >&2; printf half"}, folder / "log",
                [&](const std::string& line) { lines += line + "|"; });
  EXPECT_EQ(ReadBytes(folder / "log"), "out\nerr\nhalf");
  EXPECT_EQ(lines, "out|err|half|");
  EXPECT_THROW(RunSubprocess(kShell, {"-c", "true"}, folder / "absent" / "log", {}), Error);
}

TEST(Subprocess, SurvivesMuchOutput) {
  size_t count = 0;
  RunSubprocess(kShell, {"-c", "yes 0123456789 | head -100000"}, {},
                [&](const std::string& line) { count += line == "0123456789" ? 1 : 0; });
  EXPECT_EQ(count, 100000u);
}

TEST(Subprocess, AnExceptionEndsTheProgramAndAllItStarted) {
  const auto start = std::chrono::steady_clock::now();
  pid_t grandchild = 0;
  const auto read_line = [&](const std::string& line) {
    grandchild = static_cast<pid_t>(std::stol(line));
    throw std::runtime_error("enough");
  };
  EXPECT_THROW(RunSubprocess(kShell, {"-c", "sleep 100 & echo $!; sleep 100"}, {}, read_line),
               std::runtime_error);
  ASSERT_GT(grandchild, 0);
  for (int i = 0; i < 200 && ProcessIsAlive(grandchild); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_FALSE(ProcessIsAlive(grandchild));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(FindProgram, LooksOnPathOnly) {
  EXPECT_EQ(FindProgram("/bin/sh", "").string(), "/bin/sh");
  EXPECT_TRUE(FindProgram("sh", "").is_absolute());
  for (const char* name : {"no_such_program", "", "/bin", "/etc/passwd", "/no/such/program"}) {
    try {
      FindProgram(name, "install it");
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("install it"), std::string::npos);
    }
  }
}

TEST(RunReport, ComesBackAsWritten) {
  const TemporaryFolder folder;
  RunReport report;
  report.version = "1.2.3";
  report.command = "feature_extractor";
  report.options = {{"z", "1"}, {"a", "\"quoted\"\n"}};
  report.seed = 5;
  report.num_threads = 2;
  report.images_in = 10;
  report.images_used = 8;
  report.left_out = {{"a.jpg", "is empty"}, {"b\xff.jpg", "name is no UTF-8"}};
  report.pairs = 45;
  report.points = 3000000000;
  report.stages = {{"one", 1.5, 2.5}};
  report.inputs = {{"c.jpg", 123, "00ff"}};
  WriteRunReport(folder / "run.json", report);
  const auto json = nlohmann::ordered_json::parse(ReadBytes(folder / "run.json"));
  const auto read = json.get<RunReport>();
  EXPECT_EQ(read.options, report.options);
  EXPECT_EQ(read.points, 3000000000);
  EXPECT_EQ(read.left_out[0].reason, "is empty");
  EXPECT_EQ(read.left_out[1].name, "b\xef\xbf\xbd.jpg");
  EXPECT_EQ(read.stages[0].cpu_seconds, 2.5);
  EXPECT_EQ(read.inputs[0].size, 123u);

  // The promised keys, in the promised order.
  std::string keys;
  for (const auto& item : json.items()) keys += item.key() + " ";
  EXPECT_EQ(keys,
            "version command options seed num_threads images_in images_used left_out "
            "pairs points stages peak_rss_bytes inputs ");
}

TEST(RunReport, OtherJsonIsRefused) {
  for (const char* text : {"[]", "{}", "{\"version\": 3}", "null"}) {
    const auto json = nlohmann::ordered_json::parse(text);
    EXPECT_THROW(json.get<RunReport>(), nlohmann::json::exception) << text;
  }
}

TEST(StageTimer, MeasuresWaitingAndWorkOfChildren) {
  RunReport report;
  {
    StageTimer timer(&report, "wait");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  {
    StageTimer timer(&report, "work");
    Lines(kShell, {"-c", "i=0; while [ $i -lt 200000 ]; do i=$((i+1)); done"});
  }
  ASSERT_EQ(report.stages.size(), 2u);
  EXPECT_GE(report.stages[0].wall_seconds, 0.05);
  EXPECT_LT(report.stages[0].cpu_seconds, 0.04);
  EXPECT_GT(report.stages[1].cpu_seconds, 0.01);
  EXPECT_GT(PeakRssBytes(), 1000000u);
}

}  // namespace
}  // namespace colmap_seapoint
