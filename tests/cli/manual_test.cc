// The man page and the bash completion say what `-h` says, all of it.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/cli_runner.h"

namespace colmap_seapoint {
namespace {

std::string Output(const std::vector<std::string>& arguments) {
  const CliResult result = RunProgram(SEAPOINT_PROGRAM, arguments);
  EXPECT_EQ(result.exit_code, 0) << result.Text();
  EXPECT_EQ(result.err, "");
  return result.out;
}

std::vector<std::string> Commands() {
  std::vector<std::string> commands;
  std::istringstream lines(Output({"help"}));
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, 2, "  ") == 0) commands.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  EXPECT_GE(commands.size(), 6u);
  return commands;
}

// Of `-h`: "--name (=default)" -> its text, words separated by single blanks.
std::map<std::string, std::string> HelpOf(const std::string& command) {
  std::map<std::string, std::string> options;
  std::string title;
  std::istringstream lines(Output({command, "-h"}));
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, 4, "  --") == 0) {
      title = line.find(" (") == std::string::npos ? "" : line.substr(2);
    } else if (!title.empty() && line.compare(0, 8, "        ") == 0) {
      std::string& text = options[title];
      text += (text.empty() ? "" : " ") + line.substr(8);
    }
  }
  EXPECT_GE(options.size(), 4u) << command;
  return options;
}

std::string Plain(std::string roff) {
  roff = std::regex_replace(roff, std::regex(R"(\\f[BRI])"), "");
  roff = std::regex_replace(roff, std::regex(R"(\\&)"), "");
  return std::regex_replace(roff, std::regex(R"(\\-)"), "-");
}

// Of the man page's lines ".TP", "--name (=default)", text.
std::set<std::pair<std::string, std::string>> ManOptions(const std::string& page) {
  std::set<std::pair<std::string, std::string>> options;
  std::istringstream lines(Plain(page));
  for (std::string line, title, text; std::getline(lines, line);) {
    if (line != ".TP" || !std::getline(lines, title) || !std::getline(lines, text)) continue;
    if (title.compare(0, 2, "--") == 0) options.emplace(title, text);
  }
  return options;
}

TEST(Manual, ManPageHasEveryOptionOfEveryCommand) {
  const std::string page = Output({"help", "--format", "man"});
  const auto options = ManOptions(page);
  std::set<std::string> titles;
  for (const std::string& command : Commands()) {
    EXPECT_NE(page.find(".SS " + command + "\n"), std::string::npos) << command;
    for (const auto& [title, text] : HelpOf(command)) {
      EXPECT_EQ(options.count({title, text}), 1u) << command << " " << title << ": " << text;
      titles.insert(title);
    }
  }
  for (const auto& option : options) {
    const bool is_foreign = option.first.find(".option value") != std::string::npos;
    EXPECT_TRUE(is_foreign || titles.count(option.first) == 1) << option.first;
  }
}

TEST(Manual, RoffFindsNothingToWarnOf) {
  const TemporaryFolder folder;
  WriteBytes(folder / "page.1", Output({"help", "--format", "man"}));
  const CliResult groff = RunProgram(
      "/bin/sh", {"-c", "command -v groff >/dev/null || exit 77; groff -man -Tutf8 -ww -z " +
                            (folder / "page.1").string()});
  if (groff.exit_code == 77) GTEST_SKIP() << "groff is not installed";
  EXPECT_EQ(groff.exit_code, 0);
  EXPECT_EQ(groff.err, "");
}

class BashCompletion : public testing::Test {
 protected:
  void SetUp() override {
    WriteBytes(folder_ / "completion", Output({"help", "--format", "bash"}));
  }

  // What bash would offer for the last of `words`.
  std::set<std::string> Complete(const std::vector<std::string>& words) const {
    std::string script = "set -u; source " + (folder_ / "completion").string() + "; COMP_WORDS=(";
    for (const std::string& word : words) script += " '" + word + "'";
    script +=
        "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _colmap_seapoint; "
        "for w in \"${COMPREPLY[@]}\"; do echo \"$w\"; done";
    const CliResult bash = RunProgram("/bin/bash", {"-c", script});
    EXPECT_EQ(bash.exit_code, 0) << bash.Text();
    std::istringstream lines(bash.out);
    std::set<std::string> offered;
    for (std::string line; std::getline(lines, line);) offered.insert(line);
    return offered;
  }

  TemporaryFolder folder_;
};

TEST_F(BashCompletion, OffersWhatTheHelpLists) {
  using Words = std::set<std::string>;
  const std::vector<std::string> commands = Commands();
  Words first(commands.begin(), commands.end());
  first.insert({"help", "version"});
  EXPECT_EQ(Complete({"colmap_seapoint", ""}), first);
  EXPECT_EQ(Complete({"colmap_seapoint", "feat"}), Words{"feature_extractor"});
  for (const std::string& command : commands) {
    Words expected = {"-h", "--help", "--project_path"};
    for (const auto& [title, text] : HelpOf(command)) {
      expected.insert(title.substr(0, title.find(' ')));
    }
    EXPECT_EQ(Complete({"colmap_seapoint", command, "-"}), expected) << command;
  }
  EXPECT_EQ(Complete({"colmap_seapoint", "partial_densifier", "--PartialDensification.mode", ""}),
            (Words{"partial", "complete"}));
  EXPECT_EQ(Complete({"colmap_seapoint", "feature_extractor", "--ImageReader.single_camera", ""}),
            (Words{"0", "1"}));
  EXPECT_EQ(Complete({"colmap_seapoint", "feature_extractor", "--image_path", ""}), Words());
  EXPECT_EQ(Complete({"colmap_seapoint", "no_command", "--"}), Words());
}

TEST_F(BashCompletion, IsBoundToTheProgram) {
  const CliResult bash = RunProgram(
      "/bin/bash",
      {"-c", "source " + (folder_ / "completion").string() + " && complete -p colmap_seapoint"});
  EXPECT_EQ(bash.out, "complete -o default -F _colmap_seapoint colmap_seapoint\n") << bash.Text();
}

TEST(Manual, OtherFormatsAreWrongUsage) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"help", "--format", "html"},
        {"help", "--format"},
        {"help", "me"}}) {
    EXPECT_EQ(RunProgram(SEAPOINT_PROGRAM, arguments).exit_code, 2);
  }
  EXPECT_EQ(Output({"help", "--format", "text"}), Output({"help"}));
}

}  // namespace
}  // namespace colmap_seapoint
