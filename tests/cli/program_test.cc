// The program behind main(): what is printed where, and which code it ends with.
#include "colmap_seapoint/cli/program.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/cli/command.h"
#include "tests/cli/cli_runner.h"
#include "tests/cli/synthetic_strip.h"
#include "tests/expect_error.h"

namespace colmap_seapoint {
namespace {

using Arguments = std::vector<std::string>;

// stdout of a run that is done.
std::string Output(const Arguments& arguments, ExitCode expected = kDone) {
  testing::internal::CaptureStdout();
  try {
    EXPECT_EQ(RunProgram(arguments), expected);
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
  return testing::internal::GetCapturedStdout();
}

class Program : public testing::Test {
 protected:
  void TearDown() override { SetLogLevel(LogLevel::kInfo); }  // a run sets it

  Arguments Extract(const Arguments& more = {}) const {
    Arguments arguments = {"feature_extractor",
                           "--database_path",
                           (folder_ / "d.db").string(),
                           "--image_path",
                           (folder_ / "images").string(),
                           "--SeaPointExtraction.min_num_features",
                           "100",
                           "--SeaPointExtraction.max_num_features",
                           "200"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  TemporaryFolder folder_;
};

// Of every command, so that a new one, or a new option, is not forgotten.
TEST_F(Program, NoOutputIsAnInput) {
  const auto is_path = [](const OptionInfo& option) {
    return option.name.size() > 5 && option.name.compare(option.name.size() - 5, 5, "_path") == 0;
  };
  int num_pairs = 0;
  for (size_t c = 0; c < AllCommands().size(); ++c) {
    OptionTable names;
    AllCommands()[c].bind(&names);
    int num_outputs = 0;
    for (const OptionInfo& output : names.Options()) {
      if (!output.is_output) continue;
      ++num_outputs;
      for (const OptionInfo& input : names.Options()) {
        if (!is_path(input) || input.name == output.name) continue;
        const Command command = AllCommands()[c];
        OptionTable table;
        command.bind(&table);
        for (const OptionInfo& option : table.Options()) {
          if (option.required) table.Set(option.name, (folder_ / option.name).string());
        }
        table.Set(output.name, folder_.Path().string());
        table.Set(input.name, (folder_.Path() / ".").string());
        EXPECT_USAGE_ERROR(command.run(), " is the ");
        EXPECT_TRUE(std::filesystem::is_empty(folder_.Path())) << command.name << output.name;
        ++num_pairs;
      }
    }
    EXPECT_GE(num_outputs, 1) << names.Options()[0].name;
  }
  EXPECT_GT(num_pairs, 30);
}

TEST_F(Program, CommandsHaveNamesSummariesAndFreshOptions) {
  std::set<std::string> names;
  for (const Command& command : AllCommands()) {
    EXPECT_TRUE(names.insert(command.name).second) << command.name;
    EXPECT_FALSE(command.summary.empty()) << command.name;
    EXPECT_EQ(command.summary.find('\n'), std::string::npos) << command.name;
    OptionTable table;
    command.bind(&table);
    for (const char* name : {"random_seed", "num_threads", "log_level"}) {
      EXPECT_NE(table.Find(name), nullptr) << command.name << " " << name;
    }
    EXPECT_EQ(static_cast<bool>(command.preset),
              command.name == "automatic_reconstructor" || command.name == "feature_extractor");
    EXPECT_EQ(command.foreign.group, command.name == "automatic_reconstructor" ? "Mapper" : "");
    ASSERT_EQ(table.Set("random_seed", "77"), "");
  }
  EXPECT_EQ(names.size(), 15u);
  OptionTable table;
  AllCommands()[0].bind(&table);
  EXPECT_EQ(table.Find("random_seed")->default_value, "0");
}

TEST_F(Program, ACommandWorksOnTheOptionsThatWereSet) {
  struct Options {
    std::string word = "nothing";
    void Bind(OptionTable* table) { table->Add("word", &word, "any", "ours"); }
  };
  const Command command = MakeCommand<Options>("say", "says", [](const Options& options) {
    return CommandResult{false, options.word};
  });
  OptionTable table;
  command.bind(&table);
  ASSERT_EQ(table.Set("word", "hello"), "");
  const CommandResult result = command.run();
  EXPECT_EQ(result.text, "hello");
  EXPECT_FALSE(result.is_complete);
  EXPECT_FALSE(command.preset);
  EXPECT_EQ(command.foreign.group, "");
}

TEST_F(Program, HelpIsAResult) {
  const std::string help = Output({"help"});
  EXPECT_EQ(help.rfind("colmap_seapoint " + Version(), 0), 0u) << help;
  for (const Command& command : AllCommands()) {
    EXPECT_NE(help.find("  " + command.name + " "), std::string::npos) << command.name;
    EXPECT_NE(help.find(command.summary + "\n"), std::string::npos) << command.name;
  }
  EXPECT_EQ(Output({"-h"}), help);
  EXPECT_EQ(Output({"--help"}), help);
  EXPECT_EQ(Output({"help", "--format", "text"}), help);
  EXPECT_EQ(Output({"help", "cloud_comparer"}), Output({"cloud_comparer", "-h"}));
  EXPECT_NE(Output({"help", "--format", "man"}).find("\n.TH COLMAP_SEAPOINT 1"), std::string::npos);
  EXPECT_NE(Output({"help", "--format", "bash"}).find("\n_colmap_seapoint() {"), std::string::npos);
  EXPECT_EQ(Output({"version"}), "colmap_seapoint " + Version() + "\n");
  EXPECT_EQ(Output({"--version"}), Output({"version"}));
}

TEST_F(Program, EveryCommandDescribesItself) {
  for (const Command& command : AllCommands()) {
    const std::string help = Output({command.name, "-h"});
    EXPECT_EQ(help.rfind("colmap_seapoint " + command.name + ": " + command.summary, 0), 0u);
    EXPECT_NE(help.find("--num_threads (=-1)"), std::string::npos) << command.name;
  }
}

TEST_F(Program, WrongUsageIsThrown) {
  EXPECT_USAGE_ERROR(RunProgram(Arguments{"help", "--format", "html"}),
                     "--format text, man, bash or markdown");
  EXPECT_USAGE_ERROR(RunProgram(Arguments{"help", "me"}), "--format");
  EXPECT_USAGE_ERROR(RunProgram(Arguments{"dive"}), "'dive' is no command");
  EXPECT_USAGE_ERROR(RunProgram(Arguments{"feature_extractor"}), "required");
  EXPECT_USAGE_ERROR(RunProgram(Extract({"--log_level", "9"})), "--log_level 9");
  // Without a command the help is no result, and no error is lost above it.
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const std::string error = UsageErrorOf([] { RunProgram(Arguments()); });
  EXPECT_EQ(error, "no command is given");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_NE(testing::internal::GetCapturedStderr().find("usage: colmap_seapoint <command>"),
            std::string::npos);
}

TEST_F(Program, ACommandIsDoneOrIncomplete) {
  WriteStrip(folder_ / "images", 2);
  EXPECT_EQ(Output(Extract({"--log_level", "0"})), "");
  EXPECT_EQ(GetLogLevel(), LogLevel::kError);
  WriteBytes(folder_ / "images/zero.png", "");
  EXPECT_EQ(Output(Extract({"--log_level", "1"}), kIncomplete), "");
  EXPECT_EQ(GetLogLevel(), LogLevel::kWarning);
  EXPECT_ERROR(RunProgram(Arguments{"exhaustive_matcher", "--database_path",
                                    (folder_ / "absent.db").string()}),
               "absent.db");
}

}  // namespace
}  // namespace colmap_seapoint
