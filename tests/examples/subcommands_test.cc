#include "examples/subcommands.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "colmap_seapoint/base/error.h"

namespace colmap_seapoint {
namespace {

int RunTool(std::vector<std::string> arguments, int* number) {
  const Subcommand set = [number](const std::vector<std::string>& rest) {
    boost::program_options::options_description description("tool set");
    description.add_options()("help,h", "this text")("number", Default(number), "a number");
    if (!ParseOptions(description, rest)) return 0;
    if (*number < 0) throw UsageError("--number is negative");
    if (*number == 13) throw std::runtime_error("bad luck");
    return *number == 3 ? 3 : 0;
  };
  arguments.insert(arguments.begin(), "tool");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  return RunSubcommands(static_cast<int>(argv.size()), argv.data(), "tool", "tool set\n",
                        {{"set", set}});
}

TEST(SubcommandsTest, ExitCodesAndValues) {
  int number = 5;
  EXPECT_EQ(RunTool({"set"}, &number), 0);
  EXPECT_EQ(number, 5);
  EXPECT_EQ(RunTool({"set", "--number", "7"}, &number), 0);
  EXPECT_EQ(number, 7);
  EXPECT_EQ(RunTool({"set", "--number", "3"}, &number), 3);
  EXPECT_EQ(RunTool({"set", "--number", "13"}, &number), 1);
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{},
                                             {"get"},
                                             {"set", "--number", "-1"},
                                             {"set", "--number", "x"},
                                             {"set", "--num", "4"},
                                             {"set", "4"}}) {
    EXPECT_EQ(RunTool(wrong, &number), 2);
  }
}

TEST(SubcommandsTest, HelpGoesToStdout) {
  int number = 5;
  testing::internal::CaptureStdout();
  EXPECT_EQ(RunTool({"help"}, &number), 0);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "tool set\n");
  testing::internal::CaptureStdout();
  EXPECT_EQ(RunTool({"set", "-h", "--number", "-1"}, &number), 0);
  EXPECT_NE(testing::internal::GetCapturedStdout().find("--number arg (=5)"), std::string::npos);
}

}  // namespace
}  // namespace colmap_seapoint
