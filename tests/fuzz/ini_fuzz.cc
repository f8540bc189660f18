// Any file as the project of the command that takes most options.
#include <algorithm>

#include "colmap_seapoint/cli/command_line.h"
#include "tests/fuzz/fuzz_files.h"

using namespace colmap_seapoint;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string path = WriteFuzzFile("project.ini", data, size).string();
  std::vector<Command> commands = AllCommands();
  const auto command = std::find_if(commands.begin(), commands.end(), [](const Command& c) {
    return c.name == "automatic_reconstructor";
  });
  OptionTable table;
  command->bind(&table);
  Accepts([&] {
    FUZZ_REQUIRE(ParseCommandLine(*command, {std::string("--") + kProjectPath, path}, &table));
  });
  return 0;
}
