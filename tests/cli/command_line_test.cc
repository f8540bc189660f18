// The command line's rules, in process, for a command of the test's own.
#include "colmap_seapoint/cli/command_line.h"

#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "tests/cli/cli_runner.h"
#include "tests/expect_error.h"

namespace colmap_seapoint {
namespace {

using Arguments = std::vector<std::string>;

struct DiveOptions {
  std::string image_path;
  std::string quality = "survey";
  std::string note;
  bool turn = false;
  int count = 5;
  double depth_m = 12.5;
  int preset_from_count = 0;  // what Preset() saw: not an option
  std::map<std::string, std::string> mapper;

  void Bind(OptionTable* table) {
    table->AddRequired("image_path", &image_path, "folder of the pictures");
    table->Add(kQualityOption, &quality, "how good", "ours", {"field", "survey"});
    table->Add("note", &note, "any text", "ours");
    table->Add("Dive.turn", &turn, "whether to turn", "paper 2.3");
    table->Add("Dive.count", &count, "how many", "paper 2.5", 1, 100);
    table->Add("Dive.depth", &depth_m, "metres", "COLMAP", 0, 11000);
  }
  void Preset() {
    preset_from_count = count;
    if (quality == "field") count = 2;
  }
  ForeignOptions Foreign() { return {"Mapper", "handed on", &mapper}; }
};

class CommandLine : public testing::Test {
 protected:
  void SetUp() override {
    command_.name = "dive";
    command_.summary = "goes down";
    command_.preset = [this] { options_.Preset(); };
    command_.foreign = options_.Foreign();
    options_.Bind(&table_);
  }

  // With the required option in front.
  bool Parse(Arguments more) {
    more.insert(more.begin(), {"--image_path", "pictures"});
    return ParseCommandLine(command_, more, &table_);
  }
  bool ParseFile(const std::string& text, Arguments more = {}) {
    WriteBytes(folder_ / "dive.ini", text);
    more.insert(more.begin(), {"--project_path", (folder_ / "dive.ini").string()});
    return ParseCommandLine(command_, more, &table_);
  }

  TemporaryFolder folder_;
  DiveOptions options_;
  OptionTable table_;
  Command command_;
};

TEST_F(CommandLine, SetsWhatIsGivenAndLeavesTheRest) {
  EXPECT_TRUE(Parse({"--Dive.count", "7", "--Dive.turn", "1", "--note", "two words"}));
  EXPECT_EQ(options_.image_path, "pictures");
  EXPECT_EQ(options_.count, 7);
  EXPECT_TRUE(options_.turn);
  EXPECT_EQ(options_.note, "two words");
  EXPECT_EQ(options_.depth_m, 12.5);
  EXPECT_EQ(options_.quality, "survey");
}

TEST_F(CommandLine, AnEqualsSignJoinsNameAndValue) {
  EXPECT_TRUE(Parse({"--Dive.depth=30", "--note=a=b"}));
  EXPECT_EQ(options_.depth_m, 30);
  EXPECT_EQ(options_.note, "a=b");
}

TEST_F(CommandLine, BooleansAreNumbersOrColmapsWords) {
  for (const auto& [text, value] :
       std::map<std::string, bool>{{"1", true}, {"0", false}, {"true", true}, {"false", false}}) {
    options_.turn = !value;
    EXPECT_TRUE(Parse({"--Dive.turn", text})) << text;
    EXPECT_EQ(options_.turn, value) << text;
  }
  for (const char* text : {"yes", "2", "True", "-1"}) {
    EXPECT_USAGE_ERROR(Parse({"--Dive.turn", text}), std::string("--Dive.turn ") + text);
  }
}

TEST_F(CommandLine, ValuesMayBeginWithAMinus) {
  EXPECT_USAGE_ERROR(Parse({"--Dive.count", "-3"}), "--Dive.count -3: must lie between 1 and 100");
  EXPECT_TRUE(Parse({"--note=-x"}));
  EXPECT_EQ(options_.note, "-x");
}

TEST_F(CommandLine, ValuesMustBeLegal) {
  EXPECT_USAGE_ERROR(Parse({"--Dive.count", "101"}), "must lie between 1 and 100");
  EXPECT_USAGE_ERROR(Parse({"--Dive.count", "2.5"}), "must be a whole number");
  EXPECT_USAGE_ERROR(Parse({"--Dive.count", "7x"}), "--Dive.count 7x");
  EXPECT_USAGE_ERROR(Parse({"--Dive.depth", "nan"}), "--Dive.depth nan");
  EXPECT_USAGE_ERROR(Parse({"--Dive.depth", "11000.5"}), "between 0 and 11000");
  EXPECT_USAGE_ERROR(Parse({"--quality", "best"}), "must be one of field survey");
  EXPECT_TRUE(Parse({"--Dive.count", "100", "--Dive.depth", "0"}));
}

TEST_F(CommandLine, WhatIsRequiredMustBeThere) {
  EXPECT_USAGE_ERROR(ParseCommandLine(command_, {}, &table_), "--image_path is required");
  EXPECT_USAGE_ERROR(ParseCommandLine(command_, {"--image_path="}, &table_), "image_path");
}

TEST_F(CommandLine, UnknownNamesGetASuggestionThatIsNear) {
  EXPECT_USAGE_ERROR(Parse({"--Dive.cuont", "3"}),
                     "--Dive.cuont: dive has no such option; did you mean --Dive.count?");
  const std::string far = UsageErrorOf([&] { Parse({"--altitude", "3"}); });
  EXPECT_EQ(far.find("did you mean"), std::string::npos) << far;
  EXPECT_NE(far.find("'colmap_seapoint dive -h' lists all"), std::string::npos) << far;
  // Names are not guessed from their beginning, nor from other letters' case.
  EXPECT_USAGE_ERROR(Parse({"--Dive.cou", "3"}), "no such option");
  EXPECT_USAGE_ERROR(Parse({"--dive.count", "3"}), "did you mean --Dive.count?");
}

TEST_F(CommandLine, EachOptionOnceEachValueBehindItsOption) {
  EXPECT_USAGE_ERROR(Parse({"--image_path", "others"}), "--image_path: given twice");
  EXPECT_USAGE_ERROR(Parse({"--Mapper.a", "1", "--Mapper.a", "2"}), "--Mapper.a: given twice");
  EXPECT_USAGE_ERROR(Parse({"stray"}), "'stray' stands alone");
  EXPECT_USAGE_ERROR(Parse({"--note", "two", "words"}), "'words' stands alone");
  EXPECT_USAGE_ERROR(Parse({"--note"}), "note");
}

TEST_F(CommandLine, HelpSetsNothing) {
  for (const char* help : {"-h", "--help"}) {
    EXPECT_FALSE(Parse({"--Dive.count", "7", help})) << help;
    EXPECT_FALSE(ParseCommandLine(command_, {help}, &table_)) << help;
  }
  EXPECT_EQ(options_.image_path, "");
  EXPECT_EQ(options_.count, 5);
}

TEST_F(CommandLine, ForeignOptionsAreKeptAsTyped) {
  EXPECT_TRUE(Parse({"--Mapper.min_model_size", "3", "--Mapper.any=x y"}));
  EXPECT_EQ(options_.mapper, (std::map<std::string, std::string>{{"Mapper.min_model_size", "3"},
                                                                 {"Mapper.any", "x y"}}));
  EXPECT_USAGE_ERROR(Parse({"--Mapperer.any", "1"}), "--Mapperer.any");
  command_.foreign = {};
  EXPECT_USAGE_ERROR(Parse({"--Mapper.min_model_size", "3"}), "no such option");
}

TEST_F(CommandLine, QualityPresetsWhatIsNotGivenWhereverItStands) {
  EXPECT_TRUE(Parse({"--quality", "field"}));
  EXPECT_EQ(options_.count, 2);
  options_ = DiveOptions();
  EXPECT_TRUE(Parse({"--Dive.count", "9", "--quality", "field"}));
  EXPECT_EQ(options_.count, 9);
  EXPECT_EQ(options_.preset_from_count, 5);  // the preset came first
  options_ = DiveOptions();
  EXPECT_TRUE(ParseFile("image_path=i\nquality=field\n"));
  EXPECT_EQ(options_.count, 2);
}

TEST_F(CommandLine, AProjectFileHoldsTheSameOptions) {
  EXPECT_TRUE(
      ParseFile("# a comment\nimage_path=from file\nnote=\n[Dive]\ncount=7\nturn=true\n"
                "[Mapper]\nmin_model_size=3\n"));
  EXPECT_EQ(options_.image_path, "from file");
  EXPECT_EQ(options_.count, 7);
  EXPECT_TRUE(options_.turn);
  EXPECT_EQ(options_.note, "");
  EXPECT_EQ(options_.mapper.at("Mapper.min_model_size"), "3");
}

TEST_F(CommandLine, TheCommandLineWinsOverTheFile) {
  EXPECT_TRUE(ParseFile("image_path=from file\n[Dive]\ncount=7\ndepth=3\n[Mapper]\na=1\n",
                        {"--Dive.count", "8", "--Mapper.a", "2"}));
  EXPECT_EQ(options_.count, 8);
  EXPECT_EQ(options_.depth_m, 3);
  EXPECT_EQ(options_.image_path, "from file");
  EXPECT_EQ(options_.mapper.at("Mapper.a"), "2");
}

TEST_F(CommandLine, OneProjectFileServesAllCommands) {
  // Of feature_extractor and partial_densifier, which are no commands of the test.
  EXPECT_TRUE(ParseFile("image_path=i\ndatabase_path=d\n[PartialDensification]\nmode=complete\n"));
  const std::string path = (folder_ / "dive.ini").string();
  EXPECT_USAGE_ERROR(
      ParseFile("image_path=i\n[Dive]\ncuont=3\n"),
      path + ": Dive.cuont: dive has no such option; did you mean " + path + ": Dive.count?");
  EXPECT_USAGE_ERROR(ParseFile("image_path=i\n[Nobody]\nknows=3\n"), "Nobody.knows");
}

TEST_F(CommandLine, MistakesOfAProjectFileNameIt) {
  const std::string path = (folder_ / "dive.ini").string();
  EXPECT_USAGE_ERROR(ParseFile("image_path=i\nimage_path=j\n"), path);
  EXPECT_USAGE_ERROR(ParseFile("image_path=i\nno equals sign\n"), path);
  EXPECT_USAGE_ERROR(ParseFile("image_path=i\n[Dive]\ncount=many\n"), "--Dive.count many");
  EXPECT_ERROR(ParseCommandLine(command_, {"--project_path", path + ".absent"}, &table_),
               path + ".absent: cannot be read (No such file");
  // A file cannot name another one.
  EXPECT_USAGE_ERROR(ParseFile("image_path=i\nproject_path=j\n"), "project_path");
}

TEST_F(CommandLine, HelpSaysDefaultRangeAndOrigin) {
  const auto help = [&](const std::string& name) { return OptionHelp(*table_.Find(name)); };
  EXPECT_EQ(help("image_path"), "folder of the pictures");
  EXPECT_EQ(help("Dive.turn"), "whether to turn; 0 or 1; paper 2.3");
  EXPECT_EQ(help("Dive.count"), "how many; 1 to 100; paper 2.5");
  EXPECT_EQ(help("Dive.depth"), "metres; 0 to 11000; COLMAP");
  EXPECT_EQ(help("quality"), "how good; field | survey; ours");
  EXPECT_EQ(help("note"), "any text; ours");
}

TEST_F(CommandLine, HelpOfACommandListsAll) {
  std::ostringstream out;
  PrintCommandHelp(command_, table_, out);
  const std::string text = out.str();
  EXPECT_EQ(text.rfind("colmap_seapoint dive: goes down\n", 0), 0u) << text;
  for (const char* line :
       {"  -h [ --help ]\n", "  --project_path FILE.ini\n",
        "  --image_path (required)\n        folder of the pictures\n",
        "  --Dive.count (=5)\n        how many; 1 to 100; paper 2.5\n", "  --note (=)\n",
        "  --Dive.depth (=12.5)\n", "  --Mapper.<option> VALUE\n        handed on\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
  command_.foreign = {};
  std::ostringstream without;
  PrintCommandHelp(command_, table_, without);
  EXPECT_EQ(without.str().find("Mapper"), std::string::npos);
}

TEST_F(CommandLine, LongHelpIsBrokenAtBlanks) {
  std::string help, words;
  for (int i = 0; i < 60; ++i) help += (i > 0 ? " " : "") + ("word" + std::to_string(i));
  options_ = DiveOptions();
  OptionTable table;
  table.AddRequired("long", &options_.note, help);
  std::ostringstream out;
  PrintCommandHelp(command_, table, out);
  std::istringstream lines(out.str().substr(out.str().find("--long")));
  std::string line;
  std::getline(lines, line);
  for (int num_lines = 0; std::getline(lines, line) && line.rfind("        ", 0) == 0;) {
    EXPECT_LE(line.size(), 96u) << line;
    words += (num_lines++ > 0 ? " " : "") + line.substr(8);
  }
  EXPECT_EQ(words, help);
}

TEST(ListingAskedForTest, OfAnOptionThatHasOne) {
  std::string preset, note;
  OptionTable table;
  table.Add("preset", &preset, "a name", "ours");
  table.Add("note", &note, "any text", "ours");
  table.SetListing("preset", "all names");
  EXPECT_EQ(ListingAskedFor({"--preset", "list"}, table), "all names");
  EXPECT_EQ(ListingAskedFor({"--note", "x", "--preset=help"}, table), "all names");
  EXPECT_EQ(ListingAskedFor({"--preset", "one", "--note", "list"}, table), "");
  EXPECT_EQ(ListingAskedFor({"--preset"}, table), "");
  EXPECT_EQ(ListingAskedFor({}, table), "");
}

}  // namespace
}  // namespace colmap_seapoint
