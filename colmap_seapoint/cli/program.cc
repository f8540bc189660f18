#include "colmap_seapoint/cli/program.h"

#include <algorithm>
#include <iostream>
#include <variant>

#include "colmap_seapoint/base/error.h"
#include "colmap_seapoint/base/progress.h"
#include "colmap_seapoint/base/version.h"
#include "colmap_seapoint/cli/command.h"
#include "colmap_seapoint/cli/command_line.h"
#include "colmap_seapoint/cli/manual.h"
#include "colmap_seapoint/system/memory_budget.h"
#include "colmap_seapoint/system/memory_limit.h"

namespace colmap_seapoint {
namespace {

void PrintHelp(const std::vector<Command>& commands, std::ostream& out) {
  out << "colmap_seapoint " << Version()
      << ": dense clouds from underwater pictures, an add-on to COLMAP\n\n"
      << "usage: colmap_seapoint <command> [--project_path FILE.ini] [--option value]...\n\n";
  size_t width = 0;
  for (const Command& command : commands) width = std::max(width, command.name.size());
  for (const Command& command : commands) {
    out << "  " << command.name << std::string(width + 2 - command.name.size(), ' ')
        << command.summary << "\n";
  }
  out << "\n'colmap_seapoint <command> -h' lists the options of a command.\n"
      << "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 done but some input was left out.\n";
}

// nullptr when there is none of that name.
const Command* FindCommand(const std::vector<Command>& commands, const std::string& name) {
  const auto found = std::find_if(commands.begin(), commands.end(),
                                  [&](const Command& command) { return command.name == name; });
  return found == commands.end() ? nullptr : &*found;
}

// `help [COMMAND | --format text|man|bash|markdown]`. The other formats are for the package and its
// reference: see manual.h.
ExitCode RunHelp(const std::vector<Command>& commands, const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    PrintHelp(commands, std::cout);
    return kDone;
  }
  if (const Command* command = FindCommand(commands, arguments[0]);
      command != nullptr && arguments.size() == 1) {
    OptionTable table;
    command->bind(&table);
    PrintCommandHelp(*command, table, std::cout);
    return kDone;
  }
  const std::string format =
      arguments.size() == 2 && arguments[0] == "--format" ? arguments[1] : "";
  if (format == "text") {
    PrintHelp(commands, std::cout);
  } else if (format == "man") {
    PrintManPage(commands, std::cout);
  } else if (format == "bash") {
    PrintBashCompletion(commands, std::cout);
  } else if (format == "markdown") {
    PrintMarkdown(commands, std::cout);
  } else {
    throw UsageError(
        "help takes the name of one command, or --format text, man, bash or markdown; "
        "'colmap_seapoint help' lists the commands");
  }
  return kDone;
}

// What holds for the whole process.
void ApplyRunOptions(const OptionTable& table) {
  SetLogLevel(static_cast<LogLevel>(*std::get<int*>(table.Find("log_level")->target)));
  const std::string& max_memory = *std::get<std::string*>(table.Find("max_memory")->target);
  if (max_memory.empty()) return;
  const auto bytes = ParseBytes(max_memory);
  if (!bytes) {
    throw UsageError("--max_memory " + max_memory +
                     ": must be a size as 4G or 500M, or a number of bytes");
  }
  SetMaxMemory(*bytes);
}

ExitCode RunCommand(const Command& command, const std::vector<std::string>& arguments) {
  OptionTable table;
  command.bind(&table);
  if (const std::string listing = ListingAskedFor(arguments, table); !listing.empty()) {
    std::cout << listing << std::flush;
    return kDone;
  }
  if (!ParseCommandLine(command, arguments, &table)) {
    PrintCommandHelp(command, table, std::cout);
    return kDone;
  }
  ApplyRunOptions(table);
  CommandResult result;
  {
    const Heartbeat heartbeat;
    result = command.run();
  }
  std::cout << result.text << std::flush;
  return result.is_complete ? kDone : kIncomplete;
}

}  // namespace

ExitCode RunProgram(const std::vector<std::string>& arguments) {
  const std::vector<Command> commands = AllCommands();
  if (arguments.empty()) {
    PrintHelp(commands, std::cerr);
    throw UsageError("no command is given");
  }
  const std::string& name = arguments.front();
  if (name == "help" || name == "-h" || name == "--help") {
    return RunHelp(commands, {arguments.begin() + 1, arguments.end()});
  }
  if (name == "version" || name == "--version") {
    std::cout << "colmap_seapoint " << Version() << "\n";
    return kDone;
  }
  if (const Command* command = FindCommand(commands, name)) {
    return RunCommand(*command, {arguments.begin() + 1, arguments.end()});
  }
  throw UsageError("'" + name + "' is no command; 'colmap_seapoint help' lists them");
}

}  // namespace colmap_seapoint
