// The man page and the completion, in process, for commands of the test's own.
#include <gtest/gtest.h>

#include <sstream>

#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/cli/manual.h"

namespace colmap_seapoint {
namespace {

// Values that outlive the tables of a test.
struct Values {
  std::string path, mode = "near";
  bool turn = false;
  int level = 2;
  std::map<std::string, std::string> foreign;
};

std::vector<Command> TwoCommands(Values* values) {
  Command dive, swim;
  dive.name = "dive";
  dive.summary = "goes down - and up";
  dive.bind = [values](OptionTable* table) {
    table->AddRequired("input_path", &values->path, ".folder of \\ it");
    table->Add("Water.turn", &values->turn, "turns", "ours");
    table->Add("log_level", &values->level, "how loud", "ours", 0, 3);
  };
  dive.foreign = {"Mapper", "handed on", &values->foreign};
  swim.name = "swim";
  swim.summary = "stays up";
  swim.bind = [values](OptionTable* table) {
    table->Add("mode", &values->mode, "how far", "paper 4", {"near", "far"});
    table->Add("Water.turn", &values->turn, "turns", "ours");
    table->Add("log_level", &values->level, "how loud", "ours", 0, 3);
  };
  return {dive, swim};
}

size_t Count(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

class ManPage : public testing::Test {
 protected:
  std::string Page(const std::vector<Command>& commands) const {
    std::ostringstream out;
    PrintManPage(commands, out);
    return out.str();
  }
  std::string Section(const std::string& page, const std::string& title) const {
    const size_t begin = page.find(title);
    EXPECT_NE(begin, std::string::npos) << title << page;
    if (begin == std::string::npos) return "";
    return page.substr(begin, page.find("\n.S", begin + 1) + 1 - begin);
  }
  Values values_;
};

TEST_F(ManPage, HasTheSectionsOfAManPage) {
  const std::string page = Page(TwoCommands(&values_));
  EXPECT_EQ(page.rfind(".\\\" Made by", 0), 0u);
  EXPECT_NE(page.find(".TH COLMAP_SEAPOINT 1 \"\" \"colmap_seapoint " + Version() + "\""),
            std::string::npos);
  size_t at = 0;
  for (const char* section : {"NAME", "SYNOPSIS", "DESCRIPTION", "COMMANDS", "SHARED OPTIONS",
                              "EXIT STATUS", "SEE ALSO"}) {
    const size_t found = page.find(std::string(".SH ") + section + "\n", at);
    ASSERT_NE(found, std::string::npos) << section;
    at = found;
  }
  const std::string exits = page.substr(page.find(".SH EXIT STATUS"));
  for (const char* code : {".B 0\n", ".B 1\n", ".B 2\n", ".B 3\n"}) {
    EXPECT_EQ(Count(exits, code), 1u) << code;
  }
}

TEST_F(ManPage, ACommandsOwnOptionsStandWithIt) {
  const std::string page = Page(TwoCommands(&values_));
  const std::string dive = Section(page, ".SS dive\n");
  EXPECT_EQ(dive.rfind(".SS dive\ngoes down \\- and up\n", 0), 0u) << dive;
  EXPECT_NE(dive.find("\\fB\\-\\-input_path\\fR (required)\n"), std::string::npos) << dive;
  EXPECT_NE(dive.find("\\fB\\-\\-Mapper.\\fR\\fIoption value\\fR\nhanded on\n"), std::string::npos);
  EXPECT_EQ(dive.find("mode"), std::string::npos);
  const std::string swim = Section(page, ".SS swim\n");
  EXPECT_NE(swim.find("\\fB\\-\\-mode\\fR (=near)\nhow far; near | far; paper 4\n"),
            std::string::npos)
      << swim;
  EXPECT_EQ(swim.find("Mapper"), std::string::npos);
}

TEST_F(ManPage, SharedOptionsStandOnce) {
  const std::string page = Page(TwoCommands(&values_));
  const std::string shared = Section(page, ".SS Of every command\n");
  EXPECT_NE(shared.find("log_level\\fR (=2)\nhow loud; 0 to 3; ours\n"), std::string::npos) << page;
  EXPECT_EQ(Count(page, "\\-\\-log_level"), 1u);
  EXPECT_EQ(Count(page, "\\-\\-Water.turn"), 1u);
}

TEST_F(ManPage, AGroupNamesTheCommandsThatTakeIt) {
  std::vector<Command> commands = TwoCommands(&values_);
  Command walk;
  walk.name = "walk";
  walk.bind = [this](OptionTable* table) {
    table->Add("log_level", &values_.level, "how loud", "ours", 0, 3);
  };
  commands.push_back(walk);
  const std::string group = Section(Page(commands), ".SS Of dive, swim\n");
  EXPECT_NE(group.find("\\-\\-Water.turn"), std::string::npos) << group;
  EXPECT_EQ(group.find("log_level"), std::string::npos) << group;
}

TEST_F(ManPage, AnOptionThatReadsDifferentlyStandsTwice) {
  std::vector<Command> commands = TwoCommands(&values_);
  int other_level = 1;
  commands[1].bind = [&](OptionTable* table) {
    table->Add("log_level", &other_level, "how loud", "ours", 0, 3);
  };
  const std::string page = Page(commands);
  EXPECT_NE(page.find("log_level\\fR (=2)"), std::string::npos);
  EXPECT_NE(page.find("log_level\\fR (=1)"), std::string::npos);
}

TEST_F(ManPage, TextIsNoRequestOfRoff) {
  const std::string dive = Section(Page(TwoCommands(&values_)), ".SS dive\n");
  EXPECT_NE(dive.find("\n\\&.folder of \\e it\n"), std::string::npos) << dive;
}

TEST_F(ManPage, CompletionHasCommandsOptionsAndValues) {
  std::ostringstream out;
  PrintBashCompletion(TwoCommands(&values_), out);
  const std::string script = out.str();
  EXPECT_NE(script.find("compgen -W 'dive swim help version'"), std::string::npos) << script;
  EXPECT_NE(script.find("    dive)\n      options='-h --help --project_path\n"
                        "        --input_path\n        --Water.turn\n        --log_level' ;;\n"),
            std::string::npos)
      << script;
  EXPECT_NE(script.find("    swim:--mode)\n      values='near far' ;;\n"), std::string::npos);
  EXPECT_NE(script.find("    dive:--Water.turn |\\\n      swim:--Water.turn)\n"
                        "      values='0 1' ;;\n"),
            std::string::npos)
      << script;
  EXPECT_EQ(script.find("log_level)"), std::string::npos);  // any number
  EXPECT_NE(script.find("complete -o default -F _colmap_seapoint colmap_seapoint\n"),
            std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
